//! Light transport: the tracers against each other and against what is known of a scene.

mod cameras;
mod caustics;
mod emitters;
mod engine;
mod lights;
mod reuse;
mod rims;
#[path = "../support/mod.rs"]
mod support;
mod transport;
