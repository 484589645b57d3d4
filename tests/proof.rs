//! The certificate: its derivation, adversaries against its bounds, flights and vehicles that it must cover.

mod adversary;
mod certified_flights;
mod extended_adversary;
mod published;
mod sharp_derivation;
mod vehicles;
