"""The absolute navigation of VINAG 2018, Figures 5 to 10: flights, sensors, filters, bounds."""
