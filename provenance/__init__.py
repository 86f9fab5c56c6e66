"""Records of what every step read, wrote and used."""
