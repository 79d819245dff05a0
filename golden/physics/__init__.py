"""Physics of the two rigs in floating point: what the sensors should read, and data made from it.

``beam`` and ``strain_sensor`` are the flexible digit (thesis chapter 3), ``bound`` and
``known_loads`` what its sensors let anybody know, ``gauge_rig`` and ``gauge_places`` where they
should sit, ``plate``, ``swing``, ``wobble`` and ``conditioning`` the swing on its plate (chapter 6
and Appendix 7). Lengths in m, masses in kg, forces in N, angles in rad, times in s, signals in V.
"""

GRAVITY = 9.80665  # m/s^2, a_g
