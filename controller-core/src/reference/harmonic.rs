//! Harmonic.
