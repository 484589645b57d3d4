//! Each rival in its home conditions.
