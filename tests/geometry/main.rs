//! Rays and shapes, surfaces that share a place, and how long a scene of very many takes to build.

#[path = "../support/bounded.rs"]
mod bounded;
mod building;
mod coincident;
mod rays;
#[path = "../support/mod.rs"]
mod support;
