//! Waypoints.
