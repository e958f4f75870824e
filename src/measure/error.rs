//! Error measures between two pictures, each with its formula.
