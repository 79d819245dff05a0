"""The coded targets of the recorded vectors in grams and millimetres.

Position: neighbouring placements are 6.35 mm apart (section 3.8.2) and 0.045 in the table. The
first placement of a load confirms it: it moves by half of the load's extra width (0.045 for each
12.7 mm more). Width and load: Table 3.1 and section 3.12 (load A: 50.8 mm, 23 g).
"""

# What is at full scale in the code is this much in the unit of the beam.
FULL_SCALE = 0.9
POSITION_MM = 127.0
WIDTH_MM = 50.8
LOAD_G = 23.0
