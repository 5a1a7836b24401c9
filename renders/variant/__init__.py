"""Which of Mitsuba's variants renders here."""
