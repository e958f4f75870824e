//! Intervals: what the spread of a few numbers says about their mean.
