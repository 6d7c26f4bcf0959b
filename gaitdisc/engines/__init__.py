"""Models of OpenSim and MuJoCo: what they are driven by, expanded along a record, and written back; floor 3."""
