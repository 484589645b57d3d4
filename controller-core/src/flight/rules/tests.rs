//! The table as data.
