//! Robust global position and heading tracking on SE(3) by saturated hybrid feedback.
//!
//! Every decision a quadrotor makes in flight, and no input or output at all: the control law of the paper *Robust Global
//! Position and Heading Tracking on SE(3) via Saturated Hybrid Feedback* (Martins, Cardeira, Oliveira; below: the paper), the
//! references it tracks, the certificate that proves its thrust and torque limits before take-off, and the allocation to
//! rotors. `no_std`, no allocation, no panics; the law runs in single precision.
//!
//! # The way of the data
//!
//! Once per control tick, from left to right:
//!
//! ```text
//!                                   State ─┐
//! setpoints ─> governor ─┐                 ├─> position ─> attitude_reference ─> path_lifting ─> attitude ─> Wrench
//! hover, harmonic, … ────┴─> Reference ────┘                                                                   │
//!                                                                  rotor commands <─ allocation <──────────────┘
//! ```
//!
//! and once, before flight:
//!
//! ```text
//! Vehicle, Limits, Gains, ReferenceBounds (, Rotors, thrust floor) ─> Configuration ─> Certificate ─> Certified ─> Controller
//! ```
//!
//! [`flight`] decides which of this reaches the motors: [`flight::Pilot`] takes measurements and requests, and gives thrusts or
//! a stop, by a table of [rules](flight::rules). [`controller`] composes the four steps of the law, with an example. A
//! [`Controller`](controller::Controller) for flight is made from a [`Certified`](certificate::configuration::Certified)
//! configuration and from nothing else.
//!
//! # Conventions
//!
//! - World frame: z up, gravity is -g e3. Body frame: x forward, y left, z up, thrust along +z.
//! - Rotations and quaternions are body to world; quaternions are Hamilton's, unit, scalar first (nalgebra stores the scalar
//!   last, its constructor takes it first). A quaternion's sign carries no meaning, going in.
//! - SI units; angles in radians. A heading is a point on the circle with two derivatives ([`heading::Heading`]).
//! - Time is integer microseconds where it grows without limit, seconds as `f32` where it is a period.
//! - Gains keep the paper's symbols. A trailing `~` in comments is the paper's tilde, `'` a derivative in time, e3 = (0, 0, 1).
//! - Configuration is checked once, in constructors whose errors name the field ([`error::ParameterError`]). A tick fails only on
//!   an input it cannot use ([`error::InputError`]) and leaves the controller's memory as it was.
//! - Elementary functions come from [`math`] alone and nothing is fused: the same bits on every machine.
//!
//! # What is compiled where
//!
//! The law's step, [`controller::Controller::command`], is compiled in this crate and for speed. Certificate, allocation,
//! governor and flight rules are marked `#[inline]`: the crate that calls them compiles them, as it is compiled itself,
//! and the firmware is compiled for size. Compiled for speed they would take far more of a board's flash. What they are
//! marked with says nothing about calls: in the firmware most of them are calls.
//!
//! # Features
//!
//! - `defmt`: errors can be written to defmt logs. Such a build checks on a desktop but links only for targets with a defmt logger.
//! - `uncertified`: [`controller::Controller`] can also be made from gains that nothing proves, and started from any
//!   memory. For simulations; no flight build turns it on.
//!
//! # The paper and this code
//!
//! Equation numbers are those LaTeX gives the paper's source. (19), (34) and (35) are used up by groups that print no
//! number: the data of H_theta, H_R and H_l. Modules call equations by their labels there, (FilterDynamics) for (7). Tests are given as file: function; files without a folder are
//! in this crate's `src/`, `tests/…` is at the top of the repository, `core/tests/…` is this crate's `tests/`, `host-sim/…` the
//! desktop crate's. "The independent law" is tests/independent_law.rs: `a_tick_with_table_i_agrees_with_the_plain_transcription`
//! and `a_tick_with_random_vehicles_and_gains_agrees_with_the_plain_transcription`, an f64 transcription that shares no code with this crate.
//!
//! | paper | what it says | here | checked by |
//! |---|---|---|---|
//! | Definition 1 | saturation sigma; M tanh(s / M) in Section VI | [`math::tanh_of_scaled`], [`position::PositionLaw::command`] | math.rs: `tanh_is_within_its_stated_error_odd_and_bounded`; the independent law |
//! | Section II | R(q), phi(q), Upsilon(theta), T(theta) | [`mrp::rotation`], [`mrp::from_quaternion`], [`mrp::shadow`], [`mrp::kinematics`] | tests/kinematics.rs: `parameters_and_their_shadow_describe_the_rotation_they_came_from`, `the_shadow_of_the_shadow_is_the_parameter_and_unit_length_is_the_border`, `parameters_move_as_their_kinematics_say` |
//! | (1) | rotation from MRP, sign put right | [`mrp::to_rotation`] | tests/kinematics.rs: `parameters_and_their_shadow_describe_the_rotation_they_came_from` |
//! | (2a), (2b) | the rigid body | `host_sim::plant`; its constants are [`vehicle::Vehicle`] | host-sim/src/plant/tests.rs: `agrees_with_a_plain_integration_of_the_printed_equations` |
//! | Omega_T, Omega_tau | the user's limits | [`vehicle::Limits`] | tests/cli.rs: `malformed_scenarios_exit_with_2_name_the_field_and_leave_no_output` |
//! | Assumption 1 | Omega_r: bounds K_a12, K_a3, K_j, K_s, K_nu', K_nu'' | [`reference::ReferenceBounds`], [`reference::Trajectory::bounds`] | core/tests/harmonic.rs, core/tests/waypoints.rs: `bounds_hold_at_every_instant_and_are_attained`; core/tests/harmonic.rs: `the_papers_reference_has_the_papers_bounds` |
//! | (3) | how a reference moves | [`reference::Reference`], [`governor::Governor::tick`] | core/tests/harmonic.rs, core/tests/waypoints.rs: `each_derivative_is_the_slope_of_the_one_below`; tests/governor_campaign.rs: `a_hundred_thousand_streams_never_leave_the_bounds_and_all_arrive` |
//! | (4a) | g > K_a3, thrust for the reference | [`certificate::Certificate`], rows A1 | certificate.rs: `references_that_the_vehicle_cannot_follow_at_all_fail_assumption_1`, `a_reference_that_leaves_no_upward_thrust_is_no_configuration` |
//! | (4b) | torque for the reference; U* are Lemma 1's with M_p = 0 | [`certificate::printed::desired_rates`], rows A1 | certificate.rs: `references_that_the_vehicle_cannot_follow_at_all_fail_assumption_1` |
//! | (5) | R_d from rho and heading | [`attitude_reference::DesiredAttitude::attitude`] | attitude_reference.rs: `body_z_points_along_the_command_and_body_x_over_the_heading`; the independent law |
//! | Problem 1 | what is to be achieved | [`controller::Controller`] | tests/recovery.rs: `a_thousand_random_attitudes_and_spins_settle_within_six_seconds`; tests/paper.rs: `the_papers_experiment_meets_every_published_figure` |
//! | (6) | u = u_f + g e3 + p_d'' | [`position::PositionCommand::acceleration_command`] | the independent law |
//! | (7) | the two filters | [`position::FilterTransition`] | tests/independent_law.rs: `memory_agrees_with_the_plain_transcription_along_hundreds_of_ticks`; tests/bounds.rs: `filter_states_stay_in_their_box_to_the_last_bit` |
//! | (8) | dynamics of the position errors | the vehicle's; not in the law | tests/lyapunov/position.rs: `v_1_falls_at_any_z_and_filter_states` |
//! | (9) | z = Phi_p x~_p | [`position::PositionCommand::z_1`], [`position::PositionCommand::z_2`] | the independent law; tests/lyapunov/position.rs: `v_1_falls_at_any_z_and_filter_states` |
//! | ubar_p | -sigma_p(k_p z_1 + k_v z_2), M_p < g - K_a3 | [`position::PositionCommand::feedback`], [`certificate::configuration::Configuration::new`] | the independent law; tests/cli.rs: `malformed_scenarios_exit_with_2_name_the_field_and_leave_no_output` |
//! | Theorem 1 | stability of the position loop; thrust interval | [`certificate::Certificate`], rows T1 | tests/lyapunov/position.rs: `v_1_falls_at_any_z_and_filter_states`; tests/bounds.rs: `thrust_stays_in_theorem_1s_interval_at_any_finite_state` |
//! | (10a), (10b) | T_min, T_max | [`certificate::Form::thrust`], [`certificate::configuration::Configuration::greatest_thrust_floor`] | certificate.rs: `theorem_1s_interval_is_the_published_one`; host-sim/src/claims.rs: `theorem_1_gives_the_papers_published_interval` |
//! | (11), (12) | dynamics of z, V_1 | proof only | tests/lyapunov/position.rs: `v_1_falls_at_any_z_and_filter_states`; held inputs: tests/lyapunov/held_inputs.rs: `v_1_seldom_rises_with_inputs_held_at_100_hz` |
//! | (13a) to (15) | exponential rate of V_1 | proof only; no rate is stated here | none |
//! | (16) | omega_d | [`attitude_reference::AngularMotion::velocity`] | tests/kinematics.rs: `desired_rates_are_the_derivatives_of_the_desired_attitude_along_a_flight`; the independent law |
//! | (17) | omega_d' | [`attitude_reference::AngularMotion::acceleration`] | as (16); attitude_reference.rs: `a_turning_heading_over_a_level_vehicle_is_pure_yaw` |
//! | Lemma 1 | bounds on omega_d, omega_d', as printed | [`certificate::printed::desired_rates`], [`certificate::reachable::half_l1_norm`] | certificate.rs: `table_1_is_refused_as_printed_and_in_yaw_only`; tests/sharp_derivation.rs: `the_filters_reach_what_step_1_says_and_no_more` |
//! | Lemma 1, sharper | docs/sharp-bound.md | [`certificate::sharp::desired_rates`], [`certificate::reachable::Reachable`] | certificate.rs: `table_1_is_certified_by_the_sharp_bound_within_the_published_figures`; tests/adversary.rs: `with_table_1_the_adversary_is_strong_and_the_bound_stands`, `the_bound_stands_with_300_random_configurations`; tests/sharp_derivation.rs: `every_part_of_the_angular_acceleration_is_within_its_bound` |
//! | (18) | a step of Lemma 1 | inside U_rho' U_v' of [`certificate::printed::desired_rates`] | none by itself |
//! | R~, omega~ | attitude and body-rate error | [`controller::Diagnostics::attitude_error`], [`controller::Diagnostics::angular_velocity_error`] | the independent law; tests/attitude_sign.rs: `output_and_memory_do_not_depend_on_the_sign_of_the_quaternion` |
//! | s_theta, s_omega, tau_c, tau | the saturated attitude law | [`attitude::AttitudeLaw::command`] | the independent law |
//! | (19): C, F, D, G of H_theta | jump to the shadow at 1 + delta | [`path_lifting::switching_scalar`], [`path_lifting::lift`] | path_lifting.rs: `the_switch_happens_at_one_plus_delta` |
//! | (20) | dynamics of the attitude errors | the vehicle's; not in the law | tests/lyapunov/attitude.rs: `v_2_falls_along_flows_for_rate_errors_up_to_20_rad_per_s` |
//! | Theorem 2 | stability of the attitude loop; torque bounds | [`certificate::Certificate`], rows T2 | tests/lyapunov/attitude.rs: the next rows' tests; tests/certified_flights.rs: `two_hundred_certified_configurations_never_leave_their_bounds`, `configurations_that_the_adversary_beats_do_leave_their_limits` |
//! | (21), iota | the torque condition | [`certificate::Form::torque`], [`certificate::Form::feedback_torque`] | certificate.rs: `table_1_is_refused_as_printed_and_in_yaw_only`, `table_1_is_certified_by_the_sharp_bound_within_the_published_figures` |
//! | (22a), (22b), (23) | conditions on a, b; V_2 along flows | proof only | tests/lyapunov/attitude.rs: `v_2_falls_along_flows_for_rate_errors_up_to_20_rad_per_s`; tests/lyapunov/held_inputs.rs: `v_2_seldom_rises_with_inputs_held_at_100_hz` |
//! | (24) | V_2 across jumps | proof only | tests/lyapunov/attitude.rs: `v_2_falls_across_jumps` |
//! | (25a), (25b) | exponential rate of V_2 | proof only; no rate is stated here | none |
//! | (26a) to (27d) | both loops together | [`controller::Controller::step`] in closed loop | tests/recovery.rs: `a_thousand_random_attitudes_and_spins_settle_within_six_seconds` |
//! | Theorem 3 | stability of both together | [`projection`]: why it survives the thrust projection | projection.rs: `the_perturbation_is_never_larger_than_the_papers`; tests/recovery.rs: `a_thousand_random_attitudes_and_spins_settle_within_six_seconds` |
//! | (28), (30) to (33) | constants and rates of V_3 | proof only | none |
//! | (29) | \|d\| <= 4 sqrt(2) \|theta~\| \|u\| | [`projection`] | projection.rs: `the_perturbation_is_never_larger_than_the_papers` (against the paper's d, not its bound) |
//! | Theorem 4, (34): H_R | the law on SO(3), by path lifting | [`controller::Controller::step`] | tests/recovery.rs: `a_thousand_random_attitudes_and_spins_settle_within_six_seconds`; tests/hysteresis.rs: `noise_at_a_half_turn_changes_the_lift_at_most_once_a_flight` |
//! | Remarks 1, 2 | nothing to hold | | |
//! | Table I | gains | [`gains::GainParameters::TABLE_1`], `scenarios/paper.toml` | scenario/src/tests.rs: `the_built_in_file_is_the_papers_experiment` |
//! | Section VI, Figures 1, 2 | the experiment | `host_sim::fly`, `host_sim::claims`, `host_sim::plots` | tests/paper.rs: `the_papers_experiment_meets_every_published_figure`, `it_tracks_several_times_closer_than_published` |
//! | Appendix A: Phi, dist | nearest lift to the memory | [`path_lifting::lift`] | path_lifting.rs: `the_memory_follows_in_steps_of_alpha`, `the_lift_follows_its_path_through_a_half_turn_and_switches_once_past_the_hysteresis` |
//! | Appendix A: C_m, D_m, C_q, D_q, (35): H_l | both jumps | [`path_lifting::lift`], [`path_lifting::switching_scalar`] | tests/independent_law.rs: `memory_agrees_with_the_plain_transcription_along_hundreds_of_ticks`; tests/hysteresis.rs: `without_hysteresis_the_lift_chatters` |
//! | Appendix A: output of H_l | theta~ = phi(m* Phi) | [`path_lifting::Lifted::mrp`] | as above |
//!
//! # Where the paper is not copied literally
//!
//! | the paper | here | where | checked by |
//! |---|---|---|---|
//! | (1) has a minus before its middle term, which with the paper's own R(q), phi and T describes the transpose | plus | [`mrp::to_rotation`] | tests/kinematics.rs: `parameters_and_their_shadow_describe_the_rotation_they_came_from` |
//! | the radial saturations hold the gain and are applied to an argument that is scaled already | the gain acts once | [`attitude::AttitudeLaw::command`] | the independent law |
//! | the output of H_l has m; nothing says where q_hat and m* start | m*; they start from the lift with q_0 >= 0 and m* = +1, at q_0 = 0 from the one whose first non-zero vector component is positive | [`path_lifting::lift`] | path_lifting.rs: `a_fresh_lift_takes_the_shorter_way`, `an_exact_half_turn_lifts_to_its_positive_axis` |
//! | the switch is tested on \|phi\|, infinite at q_0 = -1 | on q_0, which is the same test without the division | [`path_lifting::switching_scalar`] | path_lifting.rs: `the_switch_happens_at_one_plus_delta` |
//! | nu_d lies on the sphere S^2; torques are bounded without modulus | nu_d lies on the circle; \|tau_i\| is bounded | [`heading::Heading`], [`certificate::Form::torque`] | heading.rs: `derivatives_and_rates_say_the_same`; tests/certified_flights.rs: `two_hundred_certified_configurations_never_leave_their_bounds` |
//! | Section VI's torque bounds 0.29, 0.33, 0.48 N m do not follow from Lemma 1 (0.379, 0.446, 0.664 N m with x_f(0) = 0), and x_f(0) may be anything in a box | both forms are worked out, the sharp one decides and confirms the published figures; flight begins with x_f = 0 | [`certificate`], [`controller::Controller::reset`] | controller/tests.rs: `a_reset_controller_is_as_good_as_new`; certificate.rs: `table_1_is_refused_as_printed_and_in_yaw_only`, `table_1_is_certified_by_the_sharp_bound_within_the_published_figures` |
//! | Table I is for continuous time and ideal actuators | at 100 Hz it survives 8.5 ms of rotor lag, not a sample of delay; `host_sim::sampled_loop` says so for any gains (docs/sampled-loop.md) | `host_sim::sampled_loop` | host-sim/tests/sampled_loop/table_one.rs: `rotor_lag_costs_the_roll_loop_its_stability_at_8_5_milliseconds`, `no_attitude_loop_survives_a_sample_of_delay`; tests/rotor_lag.rs: `the_lag_at_which_the_simulation_turns_is_the_lag_at_which_the_spectral_radius_passes_one` |
//! | the filters are differential equations | their input is held between ticks, so they are advanced exactly, not by Euler steps | [`position::FilterTransition::advance`] | tests/independent_law.rs: `memory_agrees_with_the_plain_transcription_along_hundreds_of_ticks` |
//! | references lie in Omega_r by assumption | setpoints become such references in the governor; a bridge leads on from one in motion | [`governor::Governor`], [`governor::TakeOver`] | tests/governor_campaign.rs: `a_hundred_thousand_streams_never_leave_the_bounds_and_all_arrive`; governor/tests.rs: `a_reference_in_motion_is_taken_over_where_it_is_and_stopped`, `the_farthest_targets_in_the_finest_units_stay_within_the_integers` |
//! | the wrench acts as commanded | rotors deliver it with the least sum of squares, each within its range for every state and reference of the certificate | [`allocation::MinimumNorm`], [`certificate::rotors`] | tests/vehicles.rs: `every_allowed_wrench_is_within_the_rotors_and_what_flies_agrees_with_the_mixer_to_the_bit`, `without_any_margin_clipping_takes_no_more_than_rounding` |
//! | the proof for V_2 has k_theta where the fall across jumps needs gamma_theta, and its flow part drops a term in Delta | V_2 is claimed to fall for bounded body-rate errors, in continuous time, with an a / b that allows for the dropped term, and across jumps for one sqrt(3) greater (a componentwise sigma_omega is that much longer than its level); with held inputs V_2 is not monotone | proof only | tests/lyapunov/attitude.rs, tests/lyapunov/held_inputs.rs: all their tests |
//! | T = m \|u\| at every attitude | the same; with a thrust floor, an option, T = max(m u . R e3, floor) | [`projection`] | projection.rs: `the_perturbation_is_never_larger_than_the_papers`, `upside_down_it_commands_the_floor` |
//! | its vehicle's inertia exceeds the triangle inequality of rigid bodies by 3.1 % | moments are accepted up to [`vehicle::Vehicle::INERTIA_ALLOWANCE`] beyond it | [`vehicle::Vehicle::new`] | tests/cli.rs: `malformed_scenarios_exit_with_2_name_the_field_and_leave_no_output` |
#![no_std]
#![deny(unsafe_code)]
#![warn(missing_docs)]
// A tick has no way to panic; nor has configuration.
#![cfg_attr(
    not(test),
    deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable)
)]

pub mod allocation;
pub mod attitude;
pub mod attitude_reference;
pub mod certificate;
pub mod controller;
pub mod error;
pub mod flight;
pub mod gains;
pub mod governor;
pub mod heading;
pub mod math;
pub mod mrp;
pub mod path_lifting;
pub mod position;
pub mod projection;
pub mod reference;
pub mod state;
pub mod vehicle;

/// What most users need in scope.
pub mod prelude {
    pub use crate::certificate::Certificate;
    pub use crate::certificate::configuration::{Certified, Configuration, Refused};
    pub use crate::controller::{Controller, Diagnostics, Memory};
    pub use crate::error::{InputError, ParameterError};
    pub use crate::gains::{GainParameters, Gains};
    pub use crate::heading::Heading;
    pub use crate::reference::hover::Hover;
    pub use crate::reference::{Reference, ReferenceBounds, Trajectory};
    pub use crate::state::{State, Wrench};
    pub use crate::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
    pub use nalgebra::{Quaternion, Vector2, Vector3};
}
