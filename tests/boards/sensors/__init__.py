"""The inertial sensors: registers, waits and scales by their data sheets, so far as the firmware uses them."""
