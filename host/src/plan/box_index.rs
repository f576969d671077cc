//! Rectangles by place, so that a question about one corner of the arena looks at few of them.
//!
//! The arena is divided into square buckets, about one for two rectangles; each bucket lists the
//! rectangles that touch it. Lattice units.

use crate::grid::{LatticePoint, LatticeRect};

/// Entries to keep per rectangle, on average; where large rectangles would make more, buckets are larger.
const MOST_ENTRIES: f64 = 16.0;

/// Fewer rectangles than this share one bucket: looking at all of them is quicker than dividing.
const WORTH_DIVIDING: usize = 32;

/// Rectangles in buckets.
#[derive(Clone, Debug)]
pub(super) struct BoxIndex {
    whole: LatticeRect,
    /// The side of a bucket.
    side: i64,
    columns: usize,
    rows: usize,
    /// Bucket `i` lists `entries[first[i]..first[i + 1]]`.
    first: Vec<u32>,
    entries: Vec<u32>,
}

impl BoxIndex {
    /// An index of `boxes` over the part of the plane in `whole`; what lies outside is not found.
    pub(super) fn new(whole: LatticeRect, boxes: &[LatticeRect]) -> Self {
        let (width, height) =
            (i64::from(whole.x1) - i64::from(whole.x0), i64::from(whole.y1) - i64::from(whole.y0));
        let mut side = if boxes.len() < WORTH_DIVIDING {
            width.max(height) + 1
        } else {
            ((2.0 * width as f64 * height as f64 / boxes.len() as f64).sqrt() as i64).max(1)
        };
        while entries_at_most(whole, boxes, side) > MOST_ENTRIES * boxes.len() as f64
            && side <= width.max(height)
        {
            side *= 2;
        }
        let (columns, rows) = ((width / side + 1) as usize, (height / side + 1) as usize);
        let mut index = Self {
            whole,
            side,
            columns,
            rows,
            first: vec![0; columns * rows + 2],
            entries: vec![],
        };
        for &rect in boxes {
            index.buckets(rect).for_each(|bucket| index.first[bucket + 2] += 1);
        }
        for bucket in 2..index.first.len() {
            index.first[bucket] += index.first[bucket - 1];
        }
        index.entries = vec![0; index.first.last().map_or(0, |&last| last as usize)];
        for (number, &rect) in boxes.iter().enumerate() {
            for bucket in index.buckets(rect) {
                let place = &mut index.first[bucket + 1];
                index.entries[*place as usize] = number as u32;
                *place += 1;
            }
        }
        index.first.pop();
        index
    }

    /// The indices of all rectangles that touch `range`, and of some others; some more than once.
    pub(super) fn near(&self, range: LatticeRect) -> impl Iterator<Item = usize> {
        self.buckets(range).flat_map(|bucket| {
            let entries = self.first[bucket] as usize..self.first[bucket + 1] as usize;
            self.entries[entries].iter().map(|&entry| entry as usize)
        })
    }

    /// As [`Self::near`], for a point.
    pub(super) fn at(&self, point: LatticePoint) -> impl Iterator<Item = usize> {
        self.near(LatticeRect::new(point.x, point.y, point.x, point.y))
    }

    fn buckets(&self, range: LatticeRect) -> impl Iterator<Item = usize> + use<> {
        let part = range.intersection(self.whole);
        let is_empty = part.x0 > part.x1 || part.y0 > part.y1;
        let bucket =
            |value: i32, origin: i32| ((i64::from(value) - i64::from(origin)) / self.side) as usize;
        let (columns, rows) = if is_empty {
            (0..0, 0..0)
        } else {
            let (left, right) = (bucket(part.x0, self.whole.x0), bucket(part.x1, self.whole.x0));
            let (low, high) = (bucket(part.y0, self.whole.y0), bucket(part.y1, self.whole.y0));
            (left..right.min(self.columns - 1) + 1, low..high.min(self.rows - 1) + 1)
        };
        let width = self.columns;
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }
}

/// How many buckets of that side the rectangles touch together, at most.
fn entries_at_most(whole: LatticeRect, boxes: &[LatticeRect], side: i64) -> f64 {
    let along = |low: i32, high: i32| ((i64::from(high) - i64::from(low)).max(0) / side + 2) as f64;
    let each = boxes.iter().map(|rect| {
        let part = rect.intersection(whole);
        along(part.x0, part.x1) * along(part.y0, part.y1)
    });
    each.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rect() -> impl Strategy<Value = LatticeRect> {
        (-20..120_i32, -20..120_i32, 0..40_i32, 0..40_i32)
            .prop_map(|(x, y, w, h)| LatticeRect::new(x, y, x + w, y + h))
    }

    proptest! {
        #[test]
        fn everything_in_range_is_found(boxes in proptest::collection::vec(rect(), 0..80), range in rect()) {
            let whole = LatticeRect::new(0, 0, 100, 90);
            let found: Vec<usize> = BoxIndex::new(whole, &boxes).near(range).collect();
            for (number, other) in boxes.iter().enumerate() {
                let common = other.intersection(range).intersection(whole);
                if common.x0 <= common.x1 && common.y0 <= common.y1 {
                    prop_assert!(found.contains(&number), "{number} is missing");
                }
            }
        }
    }

    #[test]
    fn large_rectangles_make_no_more_entries_than_small_ones() {
        let whole = LatticeRect::new(0, 0, 1 << 20, 1 << 20);
        let boxes = vec![whole; 20_000];
        let index = BoxIndex::new(whole, &boxes);
        assert!(index.entries.len() as f64 <= MOST_ENTRIES * boxes.len() as f64);
        assert_eq!(index.at(LatticePoint::new(5, 5)).count(), boxes.len());
    }
}
