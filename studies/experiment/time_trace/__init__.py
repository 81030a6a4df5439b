"""The letter's Fig. 4: a settled orbit against time, one of its collisions, its spectrum."""
