//! C3D: the joints as points, for motion analysis (the C3D User Guide, <https://www.c3d.org>).

use crate::error::{Error, Result};
use crate::export::placement::Placement;
use crate::export::timing::frame_rate;
use crate::take::{JOINT_NAMES, Take};

/// The length of a block, bytes.
const BLOCK: usize = 512;
/// The number of the block in which the parameters begin, from 1.
const PARAMETER_BLOCK: u8 = 2;
/// The mark of a C3D file.
const MARK: u8 = 0x50;
/// Intel's order of bytes.
const INTEL: u8 = 0x54;
/// A scale below 0 says that points are reals.
const REALS: f32 = -1.0;
/// The residual of a point that is there. Deviations are not put here: readers disagree about which
/// byte of the number holds the residual.
const PRESENT: f32 = 0.0;
/// A residual below 0 says that a point is not there.
const ABSENT: f32 = -1.0;

/// The take's joints as a C3D file. A lost joint has the residual −1. The rate is even: see
/// [`largest_jitter`](super::largest_jitter).
///
/// # Errors
/// [`Error::TooLong`] for more than 65,535 frames; a take that does not keep to
/// [`Take::validate`].
pub fn c3d(take: &Take, placement: Placement) -> Result<Vec<u8>> {
    take.validate()?;
    let too_long = Error::TooLong { format: "C3D", most: usize::from(u16::MAX) };
    let frames = u16::try_from(take.frames.len()).map_err(|_| too_long)?;
    let rate = frame_rate(take) as f32;
    // Where the points begin follows from how long the parameters are, which does not depend on it.
    let blocks = parameters(frames, rate, placement, 0).len() / BLOCK;
    let data_block = u16::from(PARAMETER_BLOCK) + blocks as u16;
    let mut bytes = header(frames, rate, data_block);
    bytes.extend(parameters(frames, rate, placement, data_block));
    for frame in &take.frames {
        for joint in 0..JOINT_NAMES.len() {
            let point = match &frame.estimate {
                Some(estimate) => {
                    let at = placement.point(&take.header, estimate.joints[joint]).as_vec3();
                    [at.x, at.y, at.z, PRESENT]
                }
                None => [0.0, 0.0, 0.0, ABSENT],
            };
            bytes.extend(point.into_iter().flat_map(f32::to_le_bytes));
        }
    }
    fill_block(&mut bytes);
    Ok(bytes)
}

/// The first block.
fn header(frames: u16, rate: f32, data_block: u16) -> Vec<u8> {
    let mut bytes = vec![PARAMETER_BLOCK, MARK];
    // Points, analogue channels, first and last frame, the longest gap that was filled.
    let points = JOINT_NAMES.len() as u16;
    bytes.extend([points, 0, 1, frames, 0].into_iter().flat_map(u16::to_le_bytes));
    bytes.extend(REALS.to_le_bytes());
    // Analogue samples per frame.
    bytes.extend([data_block, 0].into_iter().flat_map(u16::to_le_bytes));
    bytes.extend(rate.to_le_bytes());
    fill_block(&mut bytes);
    bytes
}

/// The parameters, whole blocks.
fn parameters(frames: u16, rate: f32, placement: Placement, data_block: u16) -> Vec<u8> {
    let mut section = Section::default();
    let unit = placement.unit.symbol();
    section.group(1, "POINT");
    section.number(1, "USED", JOINT_NAMES.len() as u16);
    section.number(1, "FRAMES", frames);
    section.number(1, "DATA_START", data_block);
    section.real(1, "SCALE", REALS);
    section.real(1, "RATE", rate);
    section.text(1, "UNITS", unit);
    section.texts(1, "LABELS", &JOINT_NAMES);
    section.texts(1, "DESCRIPTIONS", &JOINT_NAMES.map(|_| "joint's centre, by phalanx"));
    section.group(2, "ANALOG");
    section.number(2, "USED", 0);
    section.group(3, "TRIAL");
    section.long(3, "ACTUAL_START_FIELD", 1);
    section.long(3, "ACTUAL_END_FIELD", frames);
    section.finish()
}

/// The kinds of a parameter's entries.
const LETTER: i8 = -1;
const SHORT: i8 = 2;
const REAL: i8 = 4;

/// The section of parameters as it grows.
#[derive(Default)]
struct Section(Vec<u8>);

impl Section {
    /// Names what follows and says where the next entry stands.
    fn entry(&mut self, id: i8, name: &str, content: &[u8]) {
        self.0.push(name.len() as u8);
        self.0.extend(id.to_le_bytes());
        self.0.extend(name.as_bytes());
        self.0.extend((content.len() as u16 + 2).to_le_bytes());
        self.0.extend(content);
    }

    fn group(&mut self, id: i8, name: &str) {
        // Without a description.
        self.entry(-id, name, &[0]);
    }

    fn parameter(&mut self, group: i8, name: &str, kind: i8, extents: &[u8], values: &[u8]) {
        let mut content = kind.to_le_bytes().to_vec();
        content.push(extents.len() as u8);
        content.extend(extents);
        content.extend(values);
        content.push(0);
        self.entry(group, name, &content);
    }

    fn number(&mut self, group: i8, name: &str, value: u16) {
        self.parameter(group, name, SHORT, &[], &value.to_le_bytes());
    }

    /// A number as two, its lower half first.
    fn long(&mut self, group: i8, name: &str, value: u16) {
        let halves = [value, 0].map(u16::to_le_bytes).concat();
        self.parameter(group, name, SHORT, &[2], &halves);
    }

    fn real(&mut self, group: i8, name: &str, value: f32) {
        self.parameter(group, name, REAL, &[], &value.to_le_bytes());
    }

    fn text(&mut self, group: i8, name: &str, text: &str) {
        self.parameter(group, name, LETTER, &[text.len() as u8], text.as_bytes());
    }

    /// Texts of one length, with spaces at their ends.
    fn texts(&mut self, group: i8, name: &str, texts: &[&str]) {
        let width = texts.iter().map(|text| text.len()).max().unwrap_or_default();
        let padded: Vec<String> = texts.iter().map(|text| format!("{text:width$}")).collect();
        let extents = [width as u8, texts.len() as u8];
        self.parameter(group, name, LETTER, &extents, padded.concat().as_bytes());
    }

    /// Whole blocks, led by how many they are.
    fn finish(self) -> Vec<u8> {
        // The last entry is an empty name.
        let length = 4 + self.0.len() + 2;
        let mut bytes = vec![1, MARK, length.div_ceil(BLOCK) as u8, INTEL];
        bytes.extend(self.0);
        bytes.extend([0, 0]);
        fill_block(&mut bytes);
        bytes
    }
}

fn fill_block(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(BLOCK), 0);
}
