//! Campaigns of short flights: the same bytes at any number of threads, in any split, after any interruption.

use super::super::batches;
use super::super::manifest::{CHUNK_FLIGHTS, MANIFEST_FILE};
use super::super::step::with_longest_step;
use super::super::store::{REPORT_FILE, RESULT_FILE, SCENARIO_FILE};
use super::*;
use crate::output::whole_file::WholeFile;
use std::fs;
use std::path::PathBuf;

const HUMMINGBIRD: &str = include_str!("../../../../../vehicles/hummingbird.toml");
const FLIGHT_COUNT: u64 = 4 * CHUNK_FLIGHTS + 7;

/// Flights that are too short to get anywhere.
fn text() -> String {
    format!("{HUMMINGBIRD}\n[campaign]\nduration = 1.0\ngust = 1.0\nmass = 0.1\n")
}

fn directory(test: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("host-sim-campaign-{}-{test}", std::process::id()));
    let _ = fs::remove_dir_all(&path);
    path
}

fn source(text: String) -> CampaignSource {
    CampaignSource::new(with_longest_step(&Scenario::parse(&text, "f").unwrap()), text, "f".to_owned()).unwrap()
}

fn fly(source: &CampaignSource, orders: &Orders, directory: &Path) -> Result<Summary, CampaignError> {
    campaign(source, &LawChoice::Ours, orders, directory, &Interrupt::default())
}

fn orders(part: u64, parts: u64) -> Orders {
    Orders { flights: FLIGHT_COUNT, seed: 5, shard: (part, parts) }
}

fn fly_on(threads: usize, orders: &Orders, directory: &Path) -> Summary {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| fly(&source(text()), orders, directory)).unwrap()
}

/// Every file, by name.
fn files(directory: &Path) -> Vec<(String, Vec<u8>)> {
    let read = |entry: std::io::Result<fs::DirEntry>| {
        let path = entry.unwrap().path();
        (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(&path).unwrap_or_default())
    };
    let mut files: Vec<_> = fs::read_dir(directory).unwrap().map(read).collect();
    files.sort();
    files
}

fn names(directory: &Path) -> Vec<String> {
    files(directory).into_iter().map(|(name, _)| name).collect()
}

#[test]
fn any_number_of_threads_and_shards_gives_the_same_bytes() {
    let whole = directory("whole");
    let summary = fly_on(1, &orders(1, 1), &whole);
    assert_eq!((summary.flights, summary.beyond, summary.holds), (FLIGHT_COUNT, 0, false), "{summary}");
    assert_eq!(names(&whole), [RESULT_FILE, MANIFEST_FILE, REPORT_FILE, SCENARIO_FILE, SUMMARY_FILE]);
    let expected = files(&whole);
    for threads in [2, 3] {
        let again = directory("threads");
        fly_on(threads, &orders(1, 1), &again);
        assert_eq!(files(&again), expected, "{threads} threads");
        fs::remove_dir_all(&again).unwrap();
    }
    for parts in [1, 2, 4] {
        let shards: Vec<PathBuf> = (1..=parts).map(|part| directory(&format!("{part}-of-{parts}"))).collect();
        for (part, shard) in (1..).zip(&shards) {
            fly_on(2, &orders(part, parts), shard);
        }
        let merged = directory("merged");
        let backwards: Vec<&PathBuf> = shards.iter().rev().collect();
        assert_eq!(merge(&backwards, &merged).unwrap(), summary);
        assert_eq!(files(&merged), expected, "{parts} shards");
        shards.iter().chain([&merged]).for_each(|directory| fs::remove_dir_all(directory).unwrap());
    }
    fs::remove_dir_all(&whole).unwrap();
}

#[test]
fn what_was_finished_is_not_flown_again_and_what_is_damaged_is() {
    let (whole, again) = (directory("unbroken"), directory("broken"));
    fly_on(2, &orders(1, 1), &whole);
    // As an end of the power leaves it: a chunk that is there, one that is damaged, and one that was being written.
    let source = source(text());
    let manifest = Manifest::new(&source.scenario, &source.text, FLIGHT_COUNT, 5, (1, 1));
    let store = Store::open(&again, &manifest, &source.text).unwrap();
    let flown = Store::complete(&whole).unwrap().1;
    let kept = flown[1].clone();
    store.keep(1, &kept).unwrap();
    fs::write(again.join("parts/000002.arrow"), b"ARROW1\0\0 and then nothing").unwrap();
    std::mem::forget(WholeFile::create(&again.join("parts/000003.arrow")).unwrap());
    assert!(store.part(1) == Some(kept.clone()) && store.part(2).is_none() && store.part(0).is_none());
    // A number that was changed is damage as well, where the part is sealed; those of older campaigns are not, and are
    // taken.
    let (sealed, middle) = (fs::read(again.join("parts/000001.arrow")).unwrap(), 8000);
    let part = |bytes: &[u8]| {
        fs::write(again.join("parts/000000.arrow"), bytes).unwrap();
        batches::read_sealed(&again.join("parts/000000.arrow"))
    };
    let (before, after) = (&sealed[..middle], &sealed[middle + 1..]);
    let changed = [before, &[sealed[middle] ^ 1], after].concat();
    let arrow = sealed.len() - 32;
    assert_eq!(part(&sealed[..arrow]), Some(vec![kept.clone()]));
    assert!(part(&changed[..arrow]).is_some_and(|changed| changed != [kept]) && part(&changed).is_none());
    assert!((0..arrow).step_by(13).all(|end| part(&sealed[..end]).is_none()));
    let there = fs::metadata(again.join("parts/000001.arrow")).unwrap().modified().unwrap();
    let (verdict, none) = (source.verdict().unwrap(), Interrupt::default());
    let ours = LawOnVehicle::new(&LawChoice::Ours, &source.scenario, verdict.certified()).unwrap();
    assert_eq!(Chunks::new(&source, &ours, verdict.certificate(), &store, &none).fly().unwrap(), flown);
    // One writes into a directory at a time.
    drop(store);
    assert_eq!(fs::metadata(again.join("parts/000001.arrow")).unwrap().modified().unwrap(), there);
    fly_on(2, &orders(1, 1), &again);
    assert_eq!(files(&again), files(&whole));
    [whole, again].iter().for_each(|directory| fs::remove_dir_all(directory).unwrap());
}

#[test]
fn a_directory_is_of_one_campaign() {
    let first = directory("first");
    let few = Orders { flights: 60, seed: 1, shard: (1, 1) };
    fly_on(1, &few, &first);
    let before = files(&first);
    let refuse = |orders: &Orders, text: String, expected: &str| {
        let error = fly(&source(text), orders, &first).unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("choose another --out"), "{error}");
    };
    refuse(&Orders { seed: 2, ..few }, text(), "not the same seed (1 and 2)");
    refuse(&Orders { flights: 61, ..few }, text(), "not the same number of flights (60 and 61)");
    refuse(&Orders { shard: (1, 2), ..few }, text(), "not the same shard ([1,1] and [1,2])");
    refuse(&few, format!("{}# Another.\n", text()), "not the same scenario;");
    fs::write(first.join(MANIFEST_FILE), "{}").unwrap();
    let error = fly(&source(text()), &few, &first).unwrap_err().to_string();
    assert!(error.ends_with("campaign.json: is no campaign's of this program"), "{error}");
    fs::write(first.join(MANIFEST_FILE), &before[1].1).unwrap();
    assert_eq!(files(&first), before);
    fs::remove_dir_all(&first).unwrap();
}

#[test]
fn what_cannot_be_written_in_the_end_is_found_before_anything_is_flown() {
    let out = directory("taken");
    fly_on(1, &orders(1, 1), &out);
    fs::remove_file(out.join(RESULT_FILE)).unwrap();
    fs::create_dir(out.join(RESULT_FILE)).unwrap();
    let error = fly(&source(text()), &orders(1, 1), &out).unwrap_err().to_string();
    assert!(error.contains("campaign.arrow: cannot be written"), "{error}");
    assert_eq!(fs::read_dir(out.join("parts")).unwrap().count(), 0);
    fs::remove_dir_all(&out).unwrap();
}

#[test]
fn a_scenario_that_nothing_is_thrown_from_is_named_by_its_file() {
    let (text, out) = (format!("{HUMMINGBIRD}\n[ground]\nheight = 0.0\n"), directory("grounded"));
    let grounded = CampaignSource::new(Scenario::parse(&text, "f").unwrap(), text, "mine.toml".to_owned());
    let flown = grounded.and_then(|source| fly(&source, &orders(1, 1), &out));
    let error = flown.unwrap_err().to_string();
    assert!(error.starts_with("mine.toml: ground: a campaign throws"), "{error}");
    assert!(!out.exists());
}

#[test]
fn shards_that_do_not_belong_together_are_refused() {
    let shards = [directory("one"), directory("two"), directory("other")];
    let few = |part, seed| Orders { flights: 60, seed, shard: (part, 2) };
    fly_on(2, &few(1, 1), &shards[0]);
    fly_on(2, &few(2, 1), &shards[1]);
    fly_on(2, &few(2, 9), &shards[2]);
    let out = directory("refused");
    let refuse = |shards: &[&PathBuf], expected: &str| {
        let error = merge(shards, &out).unwrap_err().to_string();
        assert!(error.contains(expected) && !out.exists(), "{error}");
    };
    let [one, two, other] = shards.each_ref();
    refuse(&[one], "expects all 2 shards of the campaign, found 1");
    refuse(&[one, one], "not the same shard ([2,2] and [1,2])");
    refuse(&[one, two, two], "not the same shard ([3,2] and [2,2])");
    refuse(&[one, other], "not the same seed (1 and 9)");
    refuse(&[one, other], &format!("{}: merge: expects each of the shards of one campaign once", other.display()));
    refuse(&[one, &out], "holds no campaign: there is no campaign.json");
    fs::remove_file(two.join(RESULT_FILE)).unwrap();
    refuse(&[one, two], "is not complete: campaign.arrow is missing or damaged");
    shards.iter().for_each(|directory| fs::remove_dir_all(directory).unwrap());
}
