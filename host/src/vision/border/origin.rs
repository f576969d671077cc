//! Which corner of the arena, as the picture shows it, is the origin of the arena frame.

/// A corner of the arena by its place in the picture.
///
/// The arena's width runs from the origin counter-clockwise, so from the lower left or the upper right along the
/// picture's rows, and from the others along its columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureCorner {
    /// Lowest at the left.
    LowerLeft,
    /// Lowest at the right.
    LowerRight,
    /// Highest at the right.
    UpperRight,
    /// Highest at the left.
    UpperLeft,
}

impl PictureCorner {
    /// All of them, counter-clockwise from the lower left.
    pub const ALL: [Self; 4] =
        [Self::LowerLeft, Self::LowerRight, Self::UpperRight, Self::UpperLeft];

    /// How many corners come before it, counter-clockwise from the lower left.
    pub(crate) fn index(self) -> usize {
        self as usize
    }

    /// The next one, counter-clockwise.
    pub(crate) fn next(self) -> Self {
        Self::ALL[(self.index() + 1) % 4]
    }

    /// Whether the arena's width runs up or down in the picture from here.
    pub(crate) fn is_upwards(self) -> bool {
        self.index() % 2 == 1
    }

    /// As an option is written.
    pub(crate) fn option(self) -> String {
        self.to_string().replace(' ', "-")
    }
}

impl std::fmt::Display for PictureCorner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::LowerLeft => "lower left",
            Self::LowerRight => "lower right",
            Self::UpperRight => "upper right",
            Self::UpperLeft => "upper left",
        })
    }
}

/// Which of four counter-clockwise corners is the lower left one: from there the sides run right, up, left and
/// down as nearly as from any.
pub(crate) fn lowest_left(corners: [[f64; 2]; 4]) -> usize {
    const AHEAD: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, -1.0], [-1.0, 0.0], [0.0, 1.0]];
    let along = |first: usize| -> f64 {
        let side = |i: usize| {
            let (a, b) = (corners[(first + i) % 4], corners[(first + i + 1) % 4]);
            let length = (b[0] - a[0]).hypot(b[1] - a[1]).max(f64::MIN_POSITIVE);
            (AHEAD[i][0] * (b[0] - a[0]) + AHEAD[i][1] * (b[1] - a[1])) / length
        };
        (0..4).map(side).sum()
    };
    // Of two that are as near, the one that is given first.
    (0..4).rev().max_by(|&a, &b| along(a).total_cmp(&along(b))).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lower_left_is_found_wherever_the_list_begins() {
        let square = [[10.0, 90.0], [90.0, 92.0], [88.0, 12.0], [12.0, 8.0]];
        for turn in 0..4 {
            let mut turned = square;
            turned.rotate_right(turn);
            assert_eq!(lowest_left(turned), turn);
        }
    }

    #[test]
    fn options_are_the_names_with_hyphens() {
        assert_eq!(PictureCorner::UpperLeft.option(), "upper-left");
        assert!(PictureCorner::LowerRight.is_upwards() && !PictureCorner::UpperRight.is_upwards());
    }
}
