"""Physics of the two rigs in floating point: expected sensor readings, and data made from them.

``beam`` and ``strain_sensor`` describe the flexible digit (thesis chapter 3). ``bound`` computes
how well its sensors can determine a load, and ``gauge_rig`` and ``gauge_places`` where they should
be. ``plate``, ``swing`` and ``conditioning`` describe the swing on its plate (chapter 6
and Appendix 7). Lengths are in m, masses in kg, forces in N, angles in rad, times in s, and signals
in V.
"""

GRAVITY = 9.80665  # m/s^2, a_g
