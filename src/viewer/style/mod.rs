//! Looks and words of the window: colours, spacing, widgets, labels, numbers in words.

pub(crate) mod labels;
pub(crate) mod material_fields;
pub(crate) mod number_field;
pub(crate) mod numbers;
pub(crate) mod subscript;
pub(crate) mod theme;
pub(crate) mod widgets;
