//! Places in the texts of a mechanism.

use std::ops::Range;

/// Bytes of the texts of a mechanism and of all that it imports, counted through: [`Sources`](crate::source::Sources)
/// knows file, line and column.
pub(crate) type Span = Range<usize>;
