//! A small SVG writer: shapes, text, a title and a legend, all in pixels with y down.
//!
//! Every picture of wmr uses the classes of [`STYLE`], so that one colour means one thing throughout:
//! grey what is there, pink what the grid method draws, red what is closed, blue the way.

use std::fmt::Write;

/// Height of the strip that holds the title, pixels.
pub const TITLE_HEIGHT: f64 = 62.0;

const LEGEND_HEIGHT: f64 = 26.0;
const PAD: f64 = 18.0;

/// The classes that shapes may name.
pub const STYLE: &str = "\
text{font-family:'DejaVu Sans','Segoe UI',Helvetica,Arial,sans-serif;fill:#2b2f36}\
.title{font-size:19px;font-weight:bold}.subtitle{font-size:13px;fill:#5d6470}\
.legend{font-size:13px}.number{fill:#7c8491}.element{font-weight:bold}\
.page{fill:#faf9f6}.floor{fill:#ffffff;stroke:#2b2f36;stroke-width:2}\
.obstacle{fill:#5d6470}.grown{fill:#e3e0d8;stroke:#a9a496;stroke-width:1}.inflated{fill:#e3e0d8}\
.inside{fill:none;stroke:#a9a496;stroke-width:1.2;stroke-dasharray:6 4}\
.border-line{stroke:#e0559a;stroke-width:1.4}.area{stroke:#e0559a;stroke-width:.6;fill:#ffffff}\
.dead{fill:#dedbd3}.live{fill:#eef6ee}.terminal{fill:#ffe9a8}.trap{fill:#f3b3ad}.chosen{fill:#dbe8fb}\
.edge{stroke:#b5bac3;stroke-width:1.3;fill:none}.best-edge{stroke:#1f6fd6;stroke-width:3;fill:none}\
.node{fill:#ffffff;stroke:#8a919d;stroke-width:1.2}.best-node{fill:#1f6fd6;stroke:#1f6fd6}\
.free0{fill:#8e5a63}.free1{fill:#c0717a}.free2{fill:#dd9590}.free3{fill:#edb9aa}.free4{fill:#f6d8c9}.free5{fill:#fcefe6}\
.on-dark{fill:#ffffff}.path{fill:none;stroke:#1f6fd6;stroke-width:3.5;stroke-linejoin:round}\
.local{fill:none;stroke:#1f6fd6;stroke-width:1.4;stroke-dasharray:3 4}\
.planned{fill:none;stroke:#8a919d;stroke-width:2;stroke-dasharray:6 4}\
.measured{fill:none;stroke:#1f6fd6;stroke-width:2}.scale{stroke:#dedbd3;stroke-width:1;fill:none}\
.kept{fill:#1f6fd6}.dropped{fill:#ffffff;stroke:#1f6fd6;stroke-width:1.4}\
.start{fill:#2e9e5b;stroke:#ffffff;stroke-width:1.5}.goal{fill:#d64533;stroke:#ffffff;stroke-width:1.5}";

/// What a legend shows before its text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Swatch {
    /// A filled square of a class.
    Fill(&'static str),
    /// A line of a class.
    Line(&'static str),
    /// A dot of a class.
    Dot(&'static str),
}

/// An SVG picture in the making.
#[derive(Clone, Debug)]
pub struct Svg {
    width: f64,
    height: f64,
    body: String,
}

impl Svg {
    /// An empty picture of `width` × `height` pixels below a strip with `title` and `subtitle`.
    ///
    /// ```
    /// let mut svg = wmr::picture::svg::Svg::new(200.0, 100.0, "Areas", "none < one");
    /// svg.circle((20.0, 80.0), 5.0, "start");
    /// assert!(svg.finish(&[]).contains("none &lt; one"));
    /// ```
    pub fn new(width: f64, height: f64, title: &str, subtitle: &str) -> Self {
        let mut svg = Self { width, height: height + TITLE_HEIGHT, body: String::new() };
        svg.text((PAD, 27.0), "title", "start", 19.0, title);
        svg.text((PAD, 48.0), "subtitle", "start", 13.0, subtitle);
        svg
    }

    /// A rectangle from its upper-left corner, size in pixels.
    pub fn rect(&mut self, (x, y): (f64, f64), (width, height): (f64, f64), class: &str) {
        self.add(format_args!(
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" class=\"{class}\"/>"
        ));
    }

    /// A line through `points`.
    pub fn polyline(&mut self, points: &[(f64, f64)], class: &str) {
        self.points("polyline", points, class);
    }

    fn points(&mut self, element: &str, points: &[(f64, f64)], class: &str) {
        let mut list = String::new();
        for (x, y) in points {
            // Writing into a string cannot fail.
            let _ = write!(list, "{x:.2},{y:.2} ");
        }
        self.add(format_args!("<{element} points=\"{}\" class=\"{class}\"/>", list.trim_end()));
    }

    /// A filled polygon with these corners.
    pub fn polygon(&mut self, corners: &[(f64, f64)], class: &str) {
        self.points("polygon", corners, class);
    }

    /// A circle.
    pub fn circle(&mut self, (x, y): (f64, f64), radius: f64, class: &str) {
        self.add(format_args!(
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" class=\"{class}\"/>"
        ));
    }

    /// Text on its base line; `anchor` is `start`, `middle` or `end`, `size` in pixels.
    pub fn text(&mut self, (x, y): (f64, f64), class: &str, anchor: &str, size: f64, text: &str) {
        let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        self.add(format_args!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" class=\"{class}\" text-anchor=\"{anchor}\" font-size=\"{size:.1}\">{text}</text>"
        ));
    }

    /// The whole document, with a legend below the picture.
    pub fn finish(mut self, legend: &[(Swatch, &str)]) -> String {
        let (mut x, mut y) = (PAD, self.height + 8.0);
        for (swatch, label) in legend {
            // About 7.6 pixels a letter; a new row where the next entry would not fit.
            let width = 44.0 + 7.6 * label.chars().count() as f64;
            if x > PAD && x + width > self.width {
                (x, y) = (PAD, y + LEGEND_HEIGHT);
            }
            self.swatch((x, y), *swatch);
            self.text((x + 26.0, y + 12.0), "legend", "start", 13.0, label);
            x += width;
        }
        let height = if legend.is_empty() { self.height } else { y + LEGEND_HEIGHT };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0}\" height=\"{1:.0}\" viewBox=\"0 0 {0:.0} {1:.0}\">\n\
             <style>{STYLE}</style>\n<rect width=\"100%\" height=\"100%\" class=\"page\"/>\n{2}</svg>\n",
            self.width, height, self.body
        )
    }

    fn swatch(&mut self, (x, y): (f64, f64), swatch: Swatch) {
        match swatch {
            Swatch::Fill(class) => self.rect((x, y), (18.0, 15.0), class),
            Swatch::Line(class) => self.polyline(&[(x, y + 7.5), (x + 20.0, y + 7.5)], class),
            Swatch::Dot(class) => self.circle((x + 9.0, y + 7.5), 6.0, class),
        }
    }

    fn add(&mut self, element: std::fmt::Arguments) {
        // Writing into a string cannot fail.
        let _ = writeln!(self.body, "{element}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_legend_too_wide_for_one_row_takes_two() {
        let entries = [(Swatch::Dot("start"), "a rather long label"); 4];
        let height = |svg: &str| {
            svg.split("height=\"").nth(1).unwrap().split('"').next().unwrap().to_owned()
        };
        let narrow = Svg::new(300.0, 100.0, "", "").finish(&entries);
        let wide = Svg::new(1200.0, 100.0, "", "").finish(&entries);
        assert!(height(&narrow).parse::<u32>().unwrap() > height(&wide).parse::<u32>().unwrap());
    }
}
