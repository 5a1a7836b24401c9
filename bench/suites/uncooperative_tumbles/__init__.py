"""The uncooperative target followed through tumbles that nobody chose."""
