//! Whose turn it is at the workers: the picture that is shown, one beside it, or others in the
//! background.

/// For whom an accumulator is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// The picture of the session's parameters.
    Shown,
    /// The picture that is compared with it, in turn with it.
    Beside,
    /// A picture that may be wanted next, while there is nothing else to do.
    Background,
}

/// A piece of work for one accumulator, and what it is good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Turn {
    pub(super) role: Role,
    /// What its snapshots carry.
    pub(super) epoch: u64,
    /// Number of the orders that it follows; others may want something else.
    pub(super) orders: u64,
}
