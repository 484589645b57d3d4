"""The Crazyflie's numbers as RotorPy states them, in a file of its form."""
import numpy as np

arm = 0.043
half = np.sqrt(0.5)

quad_params = {
    'mass': 0.03,  # kg
    'Ixx': 1.43e-5, 'Iyy': 1.43e-5, 'Izz': 2.89e-5,  # kg m^2
    'Ixy': 0.0, 'Ixz': 0.0, 'Iyz': 0.0,
    'num_rotors': 4,
    'rotor_pos': {
        'r1': arm*np.array([half, half, 0]),
        'r2': arm*np.array([half, -half, 0]),
        'r3': arm*np.array([-half, -half, 0]),
        'r4': arm*np.array([-half, half, 0]),
    },
    'rotor_directions': np.array([1, -1, 1, -1]),
    'c_Dx': 0.0, 'c_Dy': 0.0, 'c_Dz': 0.0,
    'k_eta': 2.3e-08, 'k_m': 7.8e-10,
    'k_d': 10.2506e-07, 'k_z': 7.553e-07, 'k_h': 0.0, 'k_flap': 0.0,
    'tau_m': 0.072,
    'rotor_speed_min': 0, 'rotor_speed_max': 2500,
}
