"""Looking at a spacecraft without a case: from all sides, in no particular light."""
