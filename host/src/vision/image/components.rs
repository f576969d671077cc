//! Connected regions by runs: what is alike in a row is one piece, pieces that touch those of the row
//! above are joined. A picture has far fewer runs than cells, so that regions cost one look at each cell.

use super::raster::Raster;

/// A run of wanted cells in one row: from `start` up to and without `end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) row: usize,
    pub(crate) start: usize,
    pub(crate) end: usize,
    /// The region, from 1 in the order of the regions' first cells.
    pub(crate) region: u32,
}

/// The runs of the cells that are `wanted`, row by row, and how many regions they make. Neighbours are
/// those by the four sides.
pub(crate) fn runs(mask: &Raster<bool>, wanted: bool) -> (Vec<Run>, usize) {
    let mut runs: Vec<Run> = Vec::new();
    let mut parents: Vec<u32> = Vec::new();
    let mut above = 0..0;
    for row in 0..mask.height() {
        let first = runs.len();
        let mut next = above.start;
        let cells = mask.row(row);
        let mut x = 0;
        while let Some(start) = find(cells, x, wanted) {
            let end = find(cells, start, !wanted).unwrap_or(cells.len());
            let id = runs.len() as u32;
            parents.push(id);
            while next < above.end && runs[next].end <= start {
                next += 1;
            }
            let touching = runs[next..above.end].iter().take_while(|run| run.start < end).count();
            for other in next..next + touching {
                join(&mut parents, id, other as u32);
            }
            runs.push(Run { row, start, end, region: 0 });
            x = end;
        }
        above = first..runs.len();
    }
    let count = number(&mut runs, &mut parents);
    (runs, count)
}

/// The first cell from `from` on that is `value`.
fn find(cells: &[bool], from: usize, value: bool) -> Option<usize> {
    cells.get(from..)?.iter().position(|&cell| cell == value).map(|offset| from + offset)
}

fn root(parents: &mut [u32], mut run: u32) -> u32 {
    while parents[run as usize] != run {
        let parent = parents[run as usize];
        parents[run as usize] = parents[parent as usize];
        run = parent;
    }
    run
}

/// Joins two regions; the earlier run stays the root.
fn join(parents: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parents, a), root(parents, b));
    parents[a.max(b) as usize] = a.min(b);
}

/// Numbers the regions in the order of their first runs.
fn number(runs: &mut [Run], parents: &mut [u32]) -> usize {
    let mut count = 0;
    for index in 0..runs.len() {
        let root = root(parents, index as u32) as usize;
        if root == index {
            count += 1;
            runs[index].region = count;
        } else {
            runs[index].region = runs[root].region;
        }
    }
    count as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn regions_are_those_of_a_flood(cells in proptest::collection::vec(any::<bool>(), 110), wanted: bool) {
            let mask = Raster::from_fn(11, 10, |x, y| cells[y * 11 + x]);
            let (found, count) = runs(&mask, wanted);
            let mut flooded = Raster::filled(11, 10, 0u32);
            let mut regions = 0;
            for start in 0..110i64 {
                let (x, y) = (start % 11, start / 11);
                if mask.get(x, y) != Some(wanted) || flooded.get(x, y) != Some(0) {
                    continue;
                }
                regions += 1;
                let mut open = vec![(x, y)];
                while let Some((x, y)) = open.pop() {
                    if mask.get(x, y) == Some(wanted) && flooded.get(x, y) == Some(0) {
                        flooded.set(x, y, regions);
                        open.extend([(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)]);
                    }
                }
            }
            prop_assert_eq!(count, regions as usize);
            let mut cells = 0;
            for run in found {
                for x in run.start..run.end {
                    cells += 1;
                    prop_assert_eq!(flooded.get(x as i64, run.row as i64), Some(run.region));
                }
            }
            prop_assert_eq!(cells, flooded.cells().iter().filter(|&&region| region > 0).count());
        }
    }
}
