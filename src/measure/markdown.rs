//! A report to read: tables, words, and the plots beside it.

use super::{Errors, GAIN, Report, digits};
use std::fmt::Write;

impl Report {
    /// The report as Markdown; `plots` are the names of pictures beside it, with what they show.
    pub fn markdown(&self, plots: &[(String, String)]) -> String {
        let mut page = Page::default();
        self.put_head(&mut page);
        self.put_fronts(&mut page, plots);
        self.put_maps(&mut page);
        self.put_blends(&mut page);
        self.put_offsets(&mut page);
        self.put_frames(&mut page);
        page.0
    }

    fn put_head(&self, page: &mut Page) {
        let (input, machine, region) = (&self.input, &self.machine, &self.figures.region);
        page.line(format_args!("# What the shortcuts cost on {}\n", input.heights));
        let [x, y] = input.scale_texels.map(digits);
        let scale = if x == y { x } else { format!("{x} and {y}") };
        page.line(format_args!(
            "{} x {} texels, {}, scale {scale} texels, {}, {}, green {}.",
            input.width, input.height, input.depth, input.filter, input.edge, input.convention
        ));
        if (region.width, region.height) != (input.width, input.height) {
            page.line(format_args!(
                "Measured in its middle: {} x {} texels from column {}, row {}, as a map of its own.",
                region.width, region.height, region.x, region.y
            ));
        }
        page.line(format_args!(
            "texbake {}, seed {}, times are {}; {}, {} threads, {}; baked by {}.\n",
            self.version,
            self.seed,
            if self.runs == 1 { "those of one run".into() } else { format!("medians of {} runs", self.runs) },
            machine.cpu,
            machine.cores,
            machine.system,
            machine.devices.join("; "),
        ));
        page.line(format_args!("```\n{}\n```\n", self.command));
        self.figures.notes.iter().for_each(|note| page.line(format_args!("{note}\n")));
        page.line("Errors are given as largest / what 99 of 100 do not exceed / mean.\n");
    }

    fn put_fronts(&self, page: &mut Page, plots: &[(String, String)]) {
        page.line("## What each step buys and costs\n");
        for front in &self.figures.fronts {
            page.line(format_args!("### {}\n", capital(&front.name)));
            page.line(format_args!("By {}; gains below {} % are left out.\n", front.by, 100.0 * GAIN));
            front.lines().iter().for_each(|line| page.line(format_args!("- {line}")));
            page.line("");
        }
        for (file, what) in plots {
            page.line(format_args!("![{what}]({file})\n"));
        }
    }

    fn put_maps(&self, page: &mut Page) {
        for device in &self.machine.devices {
            page.line(format_args!("## Normal maps by {device}\n"));
            page.head(&["precision", "encoding", "bits", "channels", "error, degrees", "ns/texel", "bytes/texel"], 4);
            for figure in self.figures.normal_maps.iter().filter(|figure| figure.stored.device == *device) {
                let it = &figure.stored;
                let (error, time) = (errors(&figure.error_degrees), digits(it.nanoseconds_per_texel));
                let bytes = it.bytes_per_texel.to_string();
                page.row(&[&it.precision, &it.encoding, &it.bits, &figure.channels, &error, &time, &bytes]);
            }
            page.line(format_args!("\n## Parallax maps by {device}\n"));
            page.line("Distances to n_z (2h - 1), which is between -1 and 1.\n");
            page.head(&["precision", "encoding", "bits", "error", "ns/texel", "bytes/texel"], 3);
            for figure in self.figures.parallax_maps.iter().filter(|figure| figure.stored.device == *device) {
                let it = &figure.stored;
                let (error, time) = (errors(&figure.error), digits(it.nanoseconds_per_texel));
                page.row(&[&it.precision, &it.encoding, &it.bits, &error, &time, &it.bytes_per_texel.to_string()]);
            }
            page.line("");
        }
    }

    fn put_blends(&self, page: &mut Page) {
        page.line("## Blends\n");
        let detail = self.input.detail.as_deref().unwrap_or("the same heights turned by a quarter to the right");
        page.line(format_args!(
            "With {detail}, repeated or cut from its first texel on; angles to the normals of the sum of the heights \
             (weighted: of half of each).\nIn 8 bits both maps and the result are rounded; 32f shows the formula's own \
             error. add and partial-derivative are one formula.\n"
        ));
        page.head(&["device", "method", "encoding", "bits", "error, degrees", "ns/texel", "bytes/texel"], 4);
        for it in &self.figures.blends {
            let (error, time) = (errors(&it.error_degrees), digits(it.nanoseconds_per_texel));
            let bytes = it.bytes_per_texel.to_string();
            page.row(&[&it.device, it.method, &it.encoding, &it.bits, &error, &time, &bytes]);
        }
        page.line("");
    }

    fn put_offsets(&self, page: &mut Page) {
        page.line("## Parallax\n");
        page.line(format_args!(
            "Distances to the offsets of relief intersection, in texels, on {} pixels from every side; elevation 90 is \
             straight from above.\nThe time is that of one thread of the CPU.\n",
            self.figures.pixels
        ));
        page.head(&["elevation", "method", "fetches", "error, texels", "ns/pixel"], 2);
        for it in &self.figures.offsets {
            let (elevation, error) = (digits(it.elevation_degrees), errors(&it.error_texels));
            page.row(&[&elevation, &it.method, &it.fetches.to_string(), &error, &digits(it.nanoseconds_per_pixel)]);
        }
        page.line("");
        if !self.figures.offset_times.is_empty() {
            page.line(
                "On GPUs, by the WGSL of the shader library: dispatches of many pixels, less what one without offsets \
                 takes, on the middle 512 texels of the map as textures of floats. The plane takes three lookups there.\n",
            );
            page.head(&["device", "elevation", "method", "ns/pixel"], 3);
            for it in &self.figures.offset_times {
                let time = it.nanoseconds_per_pixel.map_or("below the clock".into(), digits);
                let elevation = digits(it.elevation_degrees);
                page.row(&[&it.device, &elevation, &it.method, &time]);
            }
            page.line("");
        }
    }

    fn put_frames(&self, page: &mut Page) {
        page.line("## Tangent space\n");
        page.line(
            "Angles in degrees between the perturbed normals of pixels in perspective: to those with interpolated \
             MikkTSpace tangents, and to those of the surface itself, with the gradients of u and v in double \
             precision.\nTangents are of length one, the cotangent frame keeps the ratio of the gradients: where the \
             texture is stretched or skewed the two mean different bumps, and the surface's own are the gradients'.\n",
        );
        let head = ["mesh", "frame", "to tangents", "to the surface", "bytes/vertex", "ns/pixel"];
        page.head(&head, 2);
        for it in &self.figures.frames {
            let surface = it.to_surface_degrees.as_ref().map_or("not known".into(), errors);
            let (tangents, bytes) = (errors(&it.to_tangents_degrees), it.bytes_per_vertex.to_string());
            page.row(&[&it.mesh, it.frame, &tangents, &surface, &bytes, &digits(it.nanoseconds_per_pixel)]);
        }
    }
}

/// Largest, 99th percentile and mean.
fn errors(errors: &Errors) -> String {
    [errors.largest, errors.percentile_99, errors.mean].map(digits).join(" / ")
}

pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Markdown, line by line.
#[derive(Default)]
struct Page(String);

impl Page {
    fn line(&mut self, text: impl std::fmt::Display) {
        // A string takes all that is written into it.
        let _ = writeln!(self.0, "{text}");
    }

    /// The head of a table, whose columns from `numbers` on hold numbers.
    fn head(&mut self, names: &[&str], numbers: usize) {
        self.row(names);
        let rules: Vec<&str> = (0..names.len()).map(|i| if i < numbers { "---" } else { "---:" }).collect();
        self.row(&rules);
    }

    fn row(&mut self, cells: &[&str]) {
        let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
        self.line(format_args!("| {} |", cells.join(" | ")));
    }
}
