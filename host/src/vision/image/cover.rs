//! Few rectangles that cover a patch of cells, whatever its shape.
//!
//! First the greatest rectangles inside it, as a wall or a box would be; then what they leave is cut in two
//! as long as the rectangles around the parts are together clearly smaller than the one around the whole.
//! A patch is a list of indices into a raster of a given width.

use super::raster::Raster;
use super::rectangles::{CellRect, rectangles};

/// A rectangle has at least so many cells.
pub(crate) const LEAST_CELLS: usize = 6;
/// A cut must save at least this share of the area, and so many cells.
const LEAST_SAVED: f64 = 0.12;
const LEAST_SAVED_CELLS: f64 = 12.0;
/// Cuts in depth of one patch.
const MOST_CUTS: usize = 4;

/// The rectangle around cells of a raster of some width.
pub(crate) fn around(cells: &[usize], width: usize) -> CellRect {
    let columns = || cells.iter().map(|cell| cell % width);
    let rows = || cells.iter().map(|cell| cell / width);
    CellRect {
        x0: columns().min().unwrap_or(0),
        y0: rows().min().unwrap_or(0),
        x1: columns().max().map_or(0, |last| last + 1),
        y1: rows().max().map_or(0, |last| last + 1),
    }
}

fn area(rect: CellRect) -> f64 {
    ((rect.x1 - rect.x0) * (rect.y1 - rect.y0)) as f64
}

/// A raster up to the last row of a patch with its cells marked.
pub(crate) fn marked(patch: &[usize], width: usize) -> Raster<bool> {
    let mut mask = Raster::filled(width, around(patch, width).y1, false);
    patch.iter().for_each(|&cell| mask.cells_mut()[cell] = true);
    mask
}

/// The cells of each connected region.
pub(crate) fn regions(mask: &Raster<bool>) -> Vec<Vec<usize>> {
    let (regions, count) = mask.regions(true);
    let mut cells: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (cell, &region) in regions.cells().iter().enumerate().filter(|&(_, &region)| region > 0) {
        cells[region as usize - 1].push(cell);
    }
    cells
}

/// The greatest rectangles in a patch, and the connected regions of what they leave.
pub(crate) fn greatest(patch: &[usize], width: usize) -> (Vec<CellRect>, Vec<Vec<usize>>) {
    let whole = around(patch, width);
    let span = whole.x1 - whole.x0;
    let mut left = Raster::filled(span, whole.y1 - whole.y0, false);
    for cell in patch {
        left.cells_mut()[(cell / width - whole.y0) * span + cell % width - whole.x0] = true;
    }
    let rects = rectangles(&left, LEAST_CELLS as f64);
    for rect in &rects {
        for row in rect.y0..rect.y1 {
            left.cells_mut()[row * span + rect.x0..row * span + rect.x1].fill(false);
        }
    }
    let place = |cell: usize| (cell / span + whole.y0) * width + cell % span + whole.x0;
    let rest = regions(&left).into_iter().map(|region| region.into_iter().map(place).collect());
    let moved = |rect: CellRect| CellRect {
        x0: rect.x0 + whole.x0,
        y0: rect.y0 + whole.y0,
        x1: rect.x1 + whole.x0,
        y1: rect.y1 + whole.y0,
    };
    (rects.into_iter().map(moved).collect(), rest.collect())
}

/// Few rectangles that cover all cells of a region, by cutting it in two as long as that saves area.
pub(crate) fn cut(region: &[usize], width: usize) -> Vec<CellRect> {
    let mut rects = Vec::new();
    let mut open = vec![(region.to_vec(), 0)];
    while let Some((cells, cuts)) = open.pop() {
        let whole = around(&cells, width);
        match best_cut(&cells, width, whole).filter(|_| cuts < MOST_CUTS) {
            Some((low, high)) => open.extend([(low, cuts + 1), (high, cuts + 1)]),
            None => rects.push(whole),
        }
    }
    rects
}

/// The two parts of a patch by the cut that saves most area, if it saves enough.
fn best_cut(cells: &[usize], width: usize, whole: CellRect) -> Option<(Vec<usize>, Vec<usize>)> {
    let by_column = profile(cells, whole.x0, whole.x1, |cell| (cell % width, cell / width));
    let by_row = profile(cells, whole.y0, whole.y1, |cell| (cell / width, cell % width));
    let (saved_x, at_x) = best_of(&by_column, area(whole));
    let (saved_y, at_y) = best_of(&by_row, area(whole));
    if saved_x.max(saved_y) < (LEAST_SAVED * area(whole)).max(LEAST_SAVED_CELLS) {
        return None;
    }
    let is_low = |&cell: &usize| {
        if saved_x >= saved_y {
            cell % width < whole.x0 + at_x
        } else {
            cell / width < whole.y0 + at_y
        }
    };
    Some(cells.iter().partition(|cell| is_low(cell)))
}

/// For each line of cells the least and the greatest place along it; `None` for an empty one.
fn profile(
    cells: &[usize],
    first: usize,
    end: usize,
    place: impl Fn(usize) -> (usize, usize),
) -> Vec<Option<(usize, usize)>> {
    let mut lines = vec![None; end - first];
    for &cell in cells {
        let (line, at) = place(cell);
        let span = &mut lines[line - first];
        *span = span.map_or(Some((at, at)), |(low, high): (usize, usize)| {
            Some((low.min(at), high.max(at)))
        });
    }
    lines
}

/// The area that the best cut across lines saves, and how many lines lie before it.
fn best_of(lines: &[Option<(usize, usize)>], whole: f64) -> (f64, usize) {
    let after = areas(lines.iter().rev());
    let before = areas(lines.iter());
    (1..lines.len())
        .map(|cut| (whole - before[cut] - after[lines.len() - cut], cut))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((0.0, 0))
}

/// The areas of the rectangles around the first 0, 1, 2 … lines.
fn areas<'a>(lines: impl Iterator<Item = &'a Option<(usize, usize)>>) -> Vec<f64> {
    let mut span: Option<(usize, usize)> = None;
    let (mut first, mut areas) = (None, vec![0.0]);
    for (index, line) in lines.enumerate() {
        if let &Some((low, high)) = line {
            span = span.map_or(Some((low, high)), |(a, b)| Some((a.min(low), b.max(high))));
            first = first.or(Some(index));
        }
        let size = span
            .zip(first)
            .filter(|_| line.is_some())
            .map(|((low, high), first)| ((high - low + 1) * (index - first + 1)) as f64);
        areas.push(size.unwrap_or_else(|| areas[areas.len() - 1]));
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ell_is_cut_in_two() {
        // Ten cells wide: a bar of 8 by 2 with another of 2 by 6 below its left end.
        let cells = (0..80).filter(|cell| {
            let (x, y) = (cell % 10, cell / 10);
            x < 8 && y < 2 || x < 2
        });
        let mut rects = cut(&cells.collect::<Vec<_>>(), 10);
        rects.sort_by_key(|rect| rect.x0);
        let post = CellRect { x0: 0, y0: 0, x1: 2, y1: 8 };
        let bar = CellRect { x0: 2, y0: 0, x1: 8, y1: 2 };
        assert_eq!(rects, [post, bar]);
    }
}
