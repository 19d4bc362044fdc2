//! Takes that contradict themselves, and files that are none.

use phalanx_hand::Side;
use phalanx_io::take::{Take, read_csv, read_json_lines, read_npz, write_csv, write_json_lines};

use crate::sample;

fn text(take: &Take) -> String {
    let mut bytes = Vec::new();
    write_csv(take, &mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

fn csv_error(csv: &str) -> String {
    read_csv(csv.as_bytes()).unwrap_err().to_string()
}

#[test]
fn csv_that_is_no_take_is_refused_by_name() {
    let good = text(&sample::open_close(Side::Right));
    assert_eq!(csv_error("frame,index.pip\n0,30\n"), "take: column 'take' is absent");
    assert!(csv_error("frame;take\n0;1\n").contains("separated by ';'"));
    assert_eq!(
        csv_error(&good.replacen("index.pip_std", "index.pip", 1)),
        "take: column 'index.pip' stands twice"
    );
    assert_eq!(
        csv_error(&good.replacen("index.pip_std", "index.pip_sigma", 1)),
        "take: column 'index.pip_std' is absent"
    );
    assert_eq!(
        csv_error(&good.replacen("-6.0000", "nan", 1)),
        "take: line 2: 'nan' is not a finite number"
    );
    assert_eq!(
        csv_error(&good.replacen(",side,", ",left,", 1)),
        "take: line 2: no view is named 'left'"
    );
    assert!(
        csv_error(&good.replacen("\"\"version\"\":1", "\"\"version\"\":2", 1))
            .contains("version 2")
    );
}

#[test]
fn json_lines_that_are_no_take_are_refused_with_their_line() {
    let mut bytes = Vec::new();
    write_json_lines(&sample::open_close(Side::Right), &mut bytes).unwrap();
    let good = String::from_utf8(bytes).unwrap();
    let error = |text: &str| read_json_lines(text.as_bytes()).unwrap_err().to_string();
    assert!(error("").starts_with("take: header:"));
    assert!(error("{\"format\":\"gait\",\"version\":1}").contains("'gait'"));
    assert!(error(&good.replacen("\"index.pip\"", "\"index.knee\"", 1)).contains("line 2"));
    let short = good.replacen("\"wrist\":", "\"elbow\":", 1);
    assert!(error(&short).contains("unknown name 'elbow'"));
    assert!(error(&good.replacen("\"time\":0.1", "\"time\":0.0", 1)).contains("frame 4"));
}

#[test]
fn takes_that_contradict_themselves_are_not_written() {
    let good = sample::open_close(Side::Right);
    let refused = |change: fn(&mut Take)| {
        let mut take = good.clone();
        change(&mut take);
        write_csv(&take, std::io::sink()).unwrap_err().to_string()
    };
    assert!(refused(|take| take.frames[1].time = f64::NAN).contains("frame 2: its time"));
    assert!(refused(|take| take.frames.swap(0, 1)).contains("numbers must ascend"));
    assert!(refused(|take| take.frames[2].doubts.push("a;b".to_owned())).contains("'a;b'"));
    assert!(refused(|take| take.header.views[0].clear()).contains("view's name"));
    assert!(refused(|take| take.header.views[0] = "top".to_owned()).contains("must differ"));
    assert!(refused(|take| take.header.world_from_hand.matrix3 *= 2.0).contains("no rotation"));
    assert!(refused(|take| take.frames[0].views[0].overlap = Some(1.5)).contains("1.5"));
    let infinite = |take: &mut Take| {
        take.frames[0].estimate.as_mut().unwrap().joints[4].x = f64::INFINITY;
    };
    assert!(refused(infinite).contains("a joint is not finite"));
}

#[test]
fn archives_that_are_no_take_are_refused() {
    assert!(read_npz(b"").unwrap_err().to_string().contains("no zip archive"));
    let empty = [b"PK\x05\x06".as_slice(), &[0; 18]].concat();
    assert!(read_npz(&empty).unwrap_err().to_string().contains("'header': it is absent"));
}
