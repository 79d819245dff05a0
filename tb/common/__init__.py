"""Driver, recorder, scoreboard and runner shared by every bench."""
