"""Forced isotropic turbulence in a periodic box: a stand-in for the database that chapter 5 took its flow from."""
