use super::*;

fn model() -> Model {
    let mut model = Model::new(SceneSource::Embedded("jensen-box".to_owned()));
    model.view.position = Vec3::new(0.1, 1.0 / 3.0, -7.123_456_7e-5);
    model.view.lens = Some(LensDesc {
        radius: 0.01,
        focus_distance: 3.3,
    });
    let specs = model.settings.integrator.params;
    model
        .settings
        .params
        .set(specs, "mode", "hits")
        .expect("a mode");
    model.settings.seed = u64::MAX;
    model.settings.layers.max_depth = Some(5);
    model.settings.layers.expressions = vec!["LD.*E".parse().expect("an expression")];
    model.display = Display {
        shown: Shown::Parts([true, false, true, false]),
        exposure: 0.7,
        part_exposure: [0.0, 1.0, -2.0, 0.3],
        tonemap: ToneMap::Agx,
        false_color: true,
    };
    model
}

#[test]
fn a_state_comes_back_bit_for_bit() {
    let model = model();
    let size = UVec2::new(641, 479);
    let text = State::new(&model, size, 17, "").to_json();
    let state = State::from_json(&text).expect("a state");
    let mut restored = Model::new(state.source(None));
    state.restore(&mut restored).expect("all of it");
    let expected = Model {
        size: PictureSize::Fixed(size),
        ..model
    };
    assert!(restored == expected, "{text}");
    assert_eq!(state.passes, 17);
}

#[test]
fn what_cannot_be_used_is_said_and_changes_nothing() {
    let good = State::new(&model(), UVec2::new(64, 48), 1, "");
    let mut target = Model::new(SceneSource::Embedded("x".to_owned()));
    let mut refused = |change: fn(&mut State), word: &str| {
        let before = target.clone();
        let mut state = good.clone();
        change(&mut state);
        let error = state.restore(&mut target).expect_err(word);
        assert!(error.contains(word), "{error}");
        assert!(target == before);
    };
    refused(|s| s.integrator = "pth".to_owned(), "pth");
    refused(|s| s.size = [0, 48], "0 × 48");
    refused(|s| s.size = [16_384, 16_384], "16384");
    refused(|s| s.camera.target = s.camera.position, "target");
    refused(|s| s.display.tonemap = "gamma".to_owned(), "gamma");
    refused(|s| s.display.exposure = f32::NAN, "exposure");
    refused(
        |s| drop(s.parameters.insert("mode".to_owned(), "x".to_owned())),
        "mode",
    );
    refused(|s| s.expressions = vec!["L(".to_owned()], "L(");
}

#[test]
fn other_json_is_no_state() {
    for text in ["", "{}", "[1]", "{\"lightscope\": 1}"] {
        assert!(State::from_json(text).is_err(), "{text}");
    }
    let newer = State::new(&model(), UVec2::ONE, 1, "")
        .to_json()
        .replace("\"lightscope\": 1", "\"lightscope\": 2");
    assert!(
        State::from_json(&newer)
            .expect_err("newer")
            .contains("newer")
    );
}

#[test]
fn a_scene_that_moved_with_its_state_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("box.toml");
    let mut model = model();
    model.source = SceneSource::File(PathBuf::from("/nowhere/box.toml"));
    let state = State::new(&model, UVec2::ONE, 1, "00");
    let beside = folder.path().join("box.png");
    assert_eq!(state.source(Some(&beside)), model.source);
    std::fs::write(&scene, "").expect("a file");
    assert_eq!(state.source(Some(&beside)), SceneSource::File(scene));
    assert_eq!(state.scene_hash(), Some("00"));
}

#[test]
fn hashes_are_those_of_the_published_function() {
    // http://www.isthe.com/chongo/tech/comp/fnv/, test vectors.
    assert_eq!(hash(b""), "cbf29ce484222325");
    assert_eq!(hash(b"a"), "af63dc4c8601ec8c");
    assert_eq!(hash(b"foobar"), "85944171f73967e8");
}
