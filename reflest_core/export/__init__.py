"""An estimate as a material that other programs read: glTF, USD, Mitsuba."""
