//! Names of quantities, such as `depth_3`.

use super::ExactError;

/// The number after `prefix` in the name of a quantity.
pub(super) fn number_in(quantity: &str, prefix: &str) -> Result<f64, ExactError> {
    let number = quantity.strip_prefix(prefix).and_then(|n| n.parse().ok());
    number.ok_or_else(|| ExactError::Quantity(quantity.to_owned()))
}
