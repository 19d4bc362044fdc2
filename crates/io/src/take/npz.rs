//! A take as NumPy's NPZ: an archive of arrays, a row a frame.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use phalanx_hand::{Dof, JOINTS, Pose};

use crate::error::{Error, Result};
use crate::npy::{Array, Data};
use crate::take::frames::{
    FrameView, JOINT_NAMES, LeftOut, PoseEstimate, Take, TakeFrame, TakeHeader,
};
use crate::take::header;
use crate::take::stored_zip;

/// More codes of doubts are texts of their own, which one column each would not serve.
const MOST_CODES: usize = 1000;

/// Writes a take as NPZ, degrees, millimetres and seconds, NaN where there is nothing. Of n frames,
/// v views and d codes of doubts:
///
/// | array | shape | |
/// |---|---|---|
/// | `frame`, `time`, `found` | n | whether there is a pose |
/// | `pose`, `pose_std` | n × 28 | by `dof_names` |
/// | `joints`, `joints_std` | n × 21 × 3 | by `joint_names` |
/// | `used`, `overlap`, `left_out` | n × v | by `view_names`; why a view was left out, or nothing |
/// | `doubted` | n × d | by `doubt_codes` |
/// | `header` | – | the header as JSON |
///
/// # Errors
/// A take that does not keep to [`Take::validate`], has more than 1,000 different codes of doubts,
/// or passes the archive's 4 GiB.
pub fn write_npz(take: &Take) -> Result<Vec<u8>> {
    take.validate()?;
    let mut arrays = frame_arrays(take, &doubt_codes(take)?);
    arrays.extend(name_arrays(take, &doubt_codes(take)?));
    let files = arrays.iter().map(|(name, array)| (format!("{name}.npy"), array.to_bytes()));
    let files: Vec<(String, Vec<u8>)> = files.collect();
    stored_zip::archive(&files)
        .ok_or_else(|| problem("all", "they pass the 4 GiB of an archive; write CSV or JSON Lines"))
}

/// The arrays with a row a frame.
fn frame_arrays(take: &Take, codes: &[&str]) -> Vec<(&'static str, Array)> {
    let (frames, views) = (take.frames.len(), take.header.views.len());
    let flags = |of: &dyn Fn(&TakeFrame) -> Vec<bool>| {
        Data::Flag(take.frames.iter().flat_map(of).collect())
    };
    let index = take.frames.iter().map(|frame| i64::try_from(frame.index).unwrap_or(i64::MAX));
    let overlaps = take.frames.iter().flat_map(|frame| &frame.views);
    let overlaps = overlaps.map(|view| view.overlap.unwrap_or(f64::NAN)).collect();
    let left_out = take.frames.iter().flat_map(|frame| &frame.views);
    let left_out = left_out.map(|view| view.left_out.map_or("", LeftOut::code));
    let doubted = |frame: &TakeFrame| {
        codes.iter().map(|&code| frame.doubts.iter().any(|doubt| doubt == code)).collect()
    };
    let table = |columns: usize, data| Array { shape: vec![frames, columns], data };
    let numbers = |of: fn(&PoseEstimate) -> _| table(Dof::COUNT, Data::Real(rows(take, of)));
    let points = |of: fn(&PoseEstimate) -> _| Array {
        shape: vec![frames, JOINTS, 3],
        data: Data::Real(rows(take, of)),
    };
    vec![
        ("frame", Array::list(Data::Integer(index.collect()))),
        ("time", Array::list(Data::Real(take.frames.iter().map(|frame| frame.time).collect()))),
        ("found", Array::list(flags(&|frame| vec![frame.estimate.is_some()]))),
        ("pose", numbers(pose)),
        ("pose_std", numbers(pose_std)),
        ("joints", points(|estimate| flat(&estimate.joints))),
        ("joints_std", points(|estimate| flat(&estimate.joint_std.unwrap_or(NOWHERE)))),
        ("used", table(views, flags(&|frame| frame.views.iter().map(|view| view.used).collect()))),
        ("overlap", table(views, Data::Real(overlaps))),
        ("left_out", table(views, Data::Text(left_out.map(str::to_owned).collect()))),
        ("doubted", table(codes.len(), flags(&doubted))),
    ]
}

/// The arrays of names, and the header.
fn name_arrays(take: &Take, codes: &[&str]) -> [(&'static str, Array); 5] {
    let texts = |names: &[&str]| {
        Array::list(Data::Text(names.iter().map(|&name| name.to_owned()).collect()))
    };
    let header = Data::Text(vec![header::to_json(&take.header)]);
    [
        ("doubt_codes", texts(codes)),
        ("dof_names", texts(&Dof::ALL.map(Dof::name))),
        ("joint_names", texts(&JOINT_NAMES)),
        ("view_names", Array::list(Data::Text(take.header.views.clone()))),
        ("header", Array { shape: vec![], data: header }),
    ]
}

/// Joints where there are none.
const NOWHERE: [DVec3; JOINTS] = [DVec3::NAN; JOINTS];

/// The different codes of doubts, in order of the alphabet.
fn doubt_codes(take: &Take) -> Result<Vec<&str>> {
    let all = take.frames.iter().flat_map(|frame| &frame.doubts).map(String::as_str);
    let codes: BTreeSet<&str> = all.collect();
    if codes.len() > MOST_CODES {
        let what = format!("there are {} different doubts; at most {MOST_CODES} fit", codes.len());
        return Err(Error::TakeArray { array: "doubt_codes".to_owned(), what });
    }
    Ok(codes.into_iter().collect())
}

/// The same of every frame, NaN where there is no pose.
fn rows<const N: usize>(take: &Take, of: fn(&PoseEstimate) -> [f64; N]) -> Vec<f64> {
    let row = |frame: &TakeFrame| frame.estimate.as_ref().map_or([f64::NAN; N], of);
    take.frames.iter().flat_map(row).collect()
}

fn pose(estimate: &PoseEstimate) -> [f64; Dof::COUNT] {
    Dof::ALL.map(|dof| dof.unit().to_file(estimate.pose[dof]))
}

fn pose_std(estimate: &PoseEstimate) -> [f64; Dof::COUNT] {
    Dof::ALL.map(|dof| dof.unit().to_file(estimate.std[dof.index()].unwrap_or(f64::NAN)))
}

fn flat(points: &[DVec3; JOINTS]) -> [f64; 3 * JOINTS] {
    std::array::from_fn(|k| points[k / 3][k % 3])
}

/// Reads what [`write_npz`] writes, and what `numpy.savez` makes of the same arrays.
///
/// # Errors
/// A damaged or compressed archive, an absent array, one of another kind or shape, a frame that
/// does not keep to [`Take::validate`].
pub fn read_npz(bytes: &[u8]) -> Result<Take> {
    let table =
        Table::read(&Arrays(stored_zip::files(bytes).map_err(|what| problem("all", what))?))?;
    let frames = (0..table.time.len()).map(|row| table.frame(row)).collect::<Result<_>>()?;
    let take = Take { header: table.header, frames };
    take.validate()?;
    Ok(take)
}

/// All arrays of an archive, of one count of frames.
struct Table {
    header: TakeHeader,
    codes: Vec<String>,
    time: Vec<f64>,
    frame: Vec<i64>,
    found: Vec<bool>,
    pose: Vec<f64>,
    pose_std: Vec<f64>,
    joints: Vec<f64>,
    joints_std: Vec<f64>,
    used: Vec<bool>,
    overlap: Vec<f64>,
    left_out: Vec<Option<LeftOut>>,
    doubted: Vec<bool>,
}

impl Table {
    fn read(arrays: &Arrays<'_>) -> Result<Self> {
        let header = arrays.texts("header")?;
        let header = header::from_json(header.first().map_or("", String::as_str))?;
        let codes = arrays.texts("doubt_codes")?;
        let time = arrays.times()?;
        let (n, views) = (time.len(), header.views.len());
        Ok(Self {
            frame: arrays.integers("frame", &[n])?,
            found: arrays.flags("found", &[n])?,
            pose: arrays.reals("pose", &[n, Dof::COUNT])?,
            pose_std: arrays.reals("pose_std", &[n, Dof::COUNT])?,
            joints: arrays.reals("joints", &[n, JOINTS, 3])?,
            joints_std: arrays.reals("joints_std", &[n, JOINTS, 3])?,
            used: arrays.flags("used", &[n, views])?,
            overlap: arrays.reals("overlap", &[n, views])?,
            left_out: arrays.left_out(n * views)?,
            doubted: arrays.flags("doubted", &[n, codes.len()])?,
            header,
            codes,
            time,
        })
    }

    fn frame(&self, row: usize) -> Result<TakeFrame> {
        let index = u64::try_from(self.frame[row]);
        let views = self.header.views.len();
        let view = |view: usize| FrameView {
            used: self.used[views * row + view],
            overlap: number(self.overlap[views * row + view]),
            left_out: self.left_out[views * row + view],
        };
        let doubted = &self.doubted[self.codes.len() * row..];
        let doubts = self.codes.iter().zip(doubted).filter(|(_, doubted)| **doubted);
        Ok(TakeFrame {
            index: index.map_err(|_| problem("frame", "a number is negative"))?,
            time: self.time[row],
            estimate: self.found[row].then(|| self.estimate(row)),
            views: (0..views).map(view).collect(),
            doubts: doubts.map(|(code, _)| code.clone()).collect(),
        })
    }

    fn estimate(&self, row: usize) -> PoseEstimate {
        let points = |all: &[f64]| -> [DVec3; JOINTS] {
            std::array::from_fn(|joint| DVec3::from_slice(&all[3 * (JOINTS * row + joint)..]))
        };
        let of = |all: &[f64], dof: Dof| dof.unit().from_file(all[Dof::COUNT * row + dof.index()]);
        let joint_std = points(&self.joints_std);
        PoseEstimate {
            pose: Pose(Dof::ALL.map(|dof| of(&self.pose, dof))),
            std: Dof::ALL.map(|dof| number(of(&self.pose_std, dof))),
            joints: points(&self.joints),
            joint_std: (!joint_std.iter().all(|std| std.is_nan())).then_some(joint_std),
        }
    }
}

/// NaN stands for nothing.
fn number(value: f64) -> Option<f64> {
    (!value.is_nan()).then_some(value)
}

fn problem(array: &str, what: impl Into<String>) -> Error {
    Error::TakeArray { array: array.to_owned(), what: what.into() }
}

/// The files of an archive, read as arrays of a known kind; of a known shape where one is given.
struct Arrays<'a>(BTreeMap<String, &'a [u8]>);

impl Arrays<'_> {
    fn array(&self, name: &str) -> Result<Array> {
        let bytes = self.0.get(&format!("{name}.npy"));
        let bytes = bytes.ok_or_else(|| problem(name, "it is absent"))?;
        Array::from_bytes(bytes).map_err(|what| problem(name, what))
    }

    fn get(&self, name: &str, shape: &[usize]) -> Result<Data> {
        let array = self.array(name)?;
        if array.shape != shape {
            return Err(problem(name, format!("its shape is {:?}, not {shape:?}", array.shape)));
        }
        Ok(array.data)
    }

    /// As many as there are frames.
    fn times(&self) -> Result<Vec<f64>> {
        let array = self.array("time")?;
        self.reals("time", &[array.shape.first().copied().unwrap_or_default()])
    }

    fn reals(&self, name: &str, shape: &[usize]) -> Result<Vec<f64>> {
        match self.get(name, shape)? {
            Data::Real(values) => Ok(values),
            _ => Err(problem(name, "it is not of kind <f8")),
        }
    }

    fn integers(&self, name: &str, shape: &[usize]) -> Result<Vec<i64>> {
        match self.get(name, shape)? {
            Data::Integer(values) => Ok(values),
            _ => Err(problem(name, "it is not of kind <i8")),
        }
    }

    fn flags(&self, name: &str, shape: &[usize]) -> Result<Vec<bool>> {
        match self.get(name, shape)? {
            Data::Flag(values) => Ok(values),
            _ => Err(problem(name, "it is not of kind |b1")),
        }
    }

    /// Why views were left out; older files do not say it.
    fn left_out(&self, count: usize) -> Result<Vec<Option<LeftOut>>> {
        if !self.0.contains_key("left_out.npy") {
            return Ok(vec![None; count]);
        }
        let codes = self.texts("left_out")?;
        let known = |code: &String| code.is_empty() || LeftOut::of_code(code).is_some();
        if codes.len() != count || !codes.iter().all(known) {
            return Err(problem(
                "left_out",
                "it does not hold a known reason, or nothing, for each view",
            ));
        }
        Ok(codes.iter().map(|code| LeftOut::of_code(code)).collect())
    }

    /// Of any shape.
    fn texts(&self, name: &str) -> Result<Vec<String>> {
        match self.array(name)?.data {
            Data::Text(values) => Ok(values),
            _ => Err(problem(name, "it is not of kind <U")),
        }
    }
}
