//! Rectangles that may be outlines or tops of boxes: parts of what is not floor, as a whole and by colour.

use super::evidence::Evidence;
use crate::geometry::Rect;
use crate::vision::image::{CellRect, Raster, rectangles};

/// Neighbours whose colours differ by less belong to one face (brightness, chroma, chroma).
const SAME_FACE: [f32; 3] = [0.10, 0.05, 0.05];
/// Faces have at least this many square metres.
const LEAST_FACE: f64 = 0.0006;

/// All rectangles worth a try.
pub(crate) fn proposals(evidence: &Evidence) -> Vec<Rect> {
    let foreign = evidence.foreign();
    let least = (LEAST_FACE * evidence.frame.scale * evidence.frame.scale).max(3.0);
    let mut found: Vec<Rect> =
        rectangles(&foreign, least).into_iter().map(|cells| metres(evidence, cells)).collect();
    found.extend(faces(evidence, &foreign, least).into_iter().map(|cells| metres(evidence, cells)));
    found
}

/// The bounds of patches of one colour, trimmed of thin outgrowths.
fn faces(evidence: &Evidence, foreign: &Raster<bool>, least: f64) -> Vec<CellRect> {
    let (width, height) = (foreign.width(), foreign.height());
    let features = evidence.features.cells();
    let mut taken = Raster::filled(width, height, false);
    let mut found = Vec::new();
    for start in 0..foreign.cells().len() {
        if !foreign.cells()[start] || taken.cells()[start] {
            continue;
        }
        let mut patch = vec![start];
        taken.cells_mut()[start] = true;
        let mut next = 0;
        while let Some(&cell) = patch.get(next) {
            next += 1;
            for neighbour in foreign.beside(cell) {
                if !foreign.cells()[neighbour] || taken.cells()[neighbour] {
                    continue;
                }
                let same = (0..3).all(|part| {
                    (features[cell][part] - features[neighbour][part]).abs() < SAME_FACE[part]
                });
                if same {
                    taken.cells_mut()[neighbour] = true;
                    patch.push(neighbour);
                }
            }
        }
        if patch.len() as f64 >= least {
            found.push(trimmed(&patch, width));
        }
    }
    found
}

/// The columns and rows between the 4th and the 96th percentile of a patch's cells, a little widened.
fn trimmed(patch: &[usize], width: usize) -> CellRect {
    let range = |mut values: Vec<usize>| {
        values.sort_unstable();
        let cut = values.len() * 4 / 100;
        (values[cut], values[values.len() - 1 - cut] + 1)
    };
    let (x0, x1) = range(patch.iter().map(|cell| cell % width).collect());
    let (y0, y1) = range(patch.iter().map(|cell| cell / width).collect());
    CellRect { x0, y0, x1, y1 }
}

fn metres(evidence: &Evidence, cells: CellRect) -> Rect {
    let corner =
        |column: usize, row: usize| evidence.frame.point(column as f64 - 0.5, row as f64 - 0.5);
    let (upper_left, lower_right) = (corner(cells.x0, cells.y0), corner(cells.x1, cells.y1));
    Rect::new(upper_left.x, lower_right.y, lower_right.x, upper_left.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_patch_is_bounded_by_most_of_its_cells() {
        let block = (0..400).map(|i| (i / 20 + 5) * 100 + i % 20 + 10);
        let tail = (30..35).map(|x| 10 * 100 + x);
        let patch: Vec<usize> = block.chain(tail).collect();
        assert_eq!(trimmed(&patch, 100), CellRect { x0: 10, y0: 5, x1: 30, y1: 25 });
    }
}
