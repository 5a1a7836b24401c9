"""The uncooperative target under any Sun and at any attitude: where it is found, and where not."""
