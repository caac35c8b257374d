//! What widths a network may have: the same limits for networks made here and networks read from a file.

/// Widest layer allowed; far above what this crate is made for, low enough that no file can ask for gigabytes.
pub const MAX_WIDTH: usize = 4096;

/// A shape that no network can have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ShapeError {
    /// A layer without outputs, or with too many.
    #[error("the {what} width is {found}; give one from 1 to {most}")]
    Width {
        /// Which layer.
        what: &'static str,
        /// The width asked for.
        found: usize,
        /// The widest allowed.
        most: usize,
    },
    /// Too many layers.
    #[error("{found} hidden layers; at most {most} are possible")]
    Layers {
        /// The number asked for.
        found: usize,
        /// The most allowed.
        most: usize,
    },
}

/// Refuses a width of 0 or above [`MAX_WIDTH`].
pub(crate) fn check_width(what: &'static str, found: usize) -> Result<(), ShapeError> {
    if (1..=MAX_WIDTH).contains(&found) {
        Ok(())
    } else {
        Err(ShapeError::Width { what, found, most: MAX_WIDTH })
    }
}
