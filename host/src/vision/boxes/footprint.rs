//! Footprints held against the floor that is seen: what stands on a place hides it from every camera.
//!
//! A footprint that holds plain floor is therefore wrong, whatever else it explains: a lean or a lamp that
//! leads to one is refuted. Metres in the arena frame, cells of the plan view.

use crate::geometry::{Point, Rect};
use crate::vision::appearance::{Feature, Look, SURE};

/// A row or column of cells is floor if all but this share of it are, and their mean is so few standard
/// deviations off that of the floor beside the footprint: what is faint but there differs in the mean.
const MOST_OTHER: f64 = 0.2;
const PLAIN: f32 = 1.25;
/// The floor beside a footprint is looked at so many cells away from it.
const BESIDE: usize = 3;

/// What is left of a rectangle without the rows and columns of plain floor along its edges; `None` if that
/// is nothing.
pub(super) fn without_floor(rect: Rect, look: &Look) -> Option<Rect> {
    let frame = &look.view;
    let (left, top) = frame.cell(Point::new(rect.x0, rect.y1));
    let (right, low) = frame.cell(Point::new(rect.x1, rect.y0));
    let first = |edge: f64| edge.ceil().max(0.0) as usize;
    let after = |edge: f64, length: usize| ((edge.floor() + 1.0).max(0.0) as usize).min(length);
    let mut columns = first(left)..after(right, look.features.width());
    let mut rows = first(top)..after(low, look.features.height());
    let whole = (columns.clone(), rows.clone());
    let mean = |cells: &mut dyn Iterator<Item = (usize, usize)>| {
        let (mut count, mut others, mut sum) = (0.0_f64, 0.0_f64, [0.0_f32; 3]);
        for (column, row) in cells {
            let point = frame.point(column as f64, row as f64);
            let Some(seen) = look.seen_at(point) else { continue };
            let residual = look.floor.residual(point, seen);
            count += 1.0;
            others += f64::from(u8::from(look.floor.difference_of(residual).lit >= SURE));
            sum.iter_mut().zip(residual).for_each(|(sum, part)| *sum += part);
        }
        (others <= MOST_OTHER * count).then(|| sum.map(|sum| sum / count.max(1.0) as f32))
    };
    let is_plain = |own: Option<Feature>, beside: Option<Feature>| {
        let (Some(own), beside) = (own, beside.unwrap_or_default()) else { return false };
        let off = [own[0] - beside[0], own[1] - beside[1], own[2] - beside[2]];
        look.floor.difference_of(off).lit < PLAIN
    };
    let beyond = |range: &std::ops::Range<usize>, is_end: bool| {
        if is_end { range.end + BESIDE - 1 } else { range.start.saturating_sub(BESIDE) }
    };
    loop {
        let column_is_floor = |column: usize, is_end: bool| {
            let of = |column: usize| mean(&mut rows.clone().map(|row| (column, row)));
            is_plain(of(column), of(beyond(&whole.0, is_end)))
        };
        let row_is_floor = |row: usize, is_end: bool| {
            let of = |row: usize| mean(&mut columns.clone().map(|column| (column, row)));
            is_plain(of(row), of(beyond(&whole.1, is_end)))
        };
        if columns.is_empty() || rows.is_empty() {
            return None;
        }
        let (ends, tops) = (
            (column_is_floor(columns.start, false), column_is_floor(columns.end - 1, true)),
            (row_is_floor(rows.start, false), row_is_floor(rows.end - 1, true)),
        );
        if !(ends.0 || ends.1 || tops.0 || tops.1) {
            break;
        }
        columns = columns.start + usize::from(ends.0)..columns.end - usize::from(ends.1);
        rows = rows.start + usize::from(tops.0)..rows.end - usize::from(tops.1);
    }
    let edge = |at: usize, kept: usize, is: f64, by: f64| if at == kept { is } else { by };
    let low_corner = frame.point(columns.start as f64 - 0.5, rows.end as f64 - 0.5);
    let high_corner = frame.point(columns.end as f64 - 0.5, rows.start as f64 - 0.5);
    Some(Rect::new(
        edge(whole.0.start, columns.start, rect.x0, low_corner.x),
        edge(whole.1.end, rows.end, rect.y0, low_corner.y),
        edge(whole.0.end, columns.end, rect.x1, high_corner.x),
        edge(whole.1.start, rows.start, rect.y1, high_corner.y),
    ))
}
