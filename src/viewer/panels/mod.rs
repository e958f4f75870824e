//! The panels beside the picture and around it: one file each.

pub(crate) mod compare;
pub(crate) mod controls;
pub(crate) mod energy;
pub(crate) mod error;
pub(crate) mod export;
pub(crate) mod help;
pub(crate) mod kept;
pub(crate) mod lobe;
pub(crate) mod materials;
pub(crate) mod method;
pub(crate) mod notice;
pub(crate) mod open;
pub(crate) mod pixel;
pub(crate) mod proofs;
pub(crate) mod report;
pub(crate) mod sheet;
pub(crate) mod status;
pub(crate) mod tracing;
pub(crate) mod view;
