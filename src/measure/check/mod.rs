//! The proofs: a model at a roughness against its own laws.

pub mod quadrature;
pub mod reference;
