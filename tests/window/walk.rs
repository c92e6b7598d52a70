//! A walk through what a newcomer does.

use crate::screen::{HEIGHT, Program, Screen, WIDTH, difference, mean, reference, saved};

#[test]
fn drag_resize_solo_screenshot_quit() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let mut program = Program::start(&screen, folder.path(), &reference("cornell-diffuse"));
    program.wait_for_picture();
    let still = program.settle();

    program.drag("1", [250, 250], [120, 40]);
    program.wait_for("a drag turns the view", |p| difference(p, &still) > 8.0);
    program.key("Home");
    program.wait_for("Home leads back", |p| difference(p, &still) < 3.0);

    program.key("3");
    program.wait_for("there are no caustics here", |p| mean(p) < 2.0);
    program.key("0");
    program.wait_for("0 shows the whole again", |p| difference(p, &still) < 3.0);

    program.resize(700, 500);
    program.wait_for("another size is another picture", |p| {
        difference(p, &still) > 3.0
    });
    program.resize(900, 640);
    program.wait_for("the old size shows the old picture", |p| {
        difference(p, &still) < 3.0
    });

    program.key("ctrl+s");
    let png = image::open(saved(folder.path(), "spp.png"))
        .expect("a PNG")
        .to_rgb8();
    program.key("ctrl+e");
    let exr = saved(folder.path(), "spp.exr");
    let size = exr::meta::MetaData::read_from_file(&exr, false).expect("an EXR");
    let data = size.headers[0].shared_attributes.display_window.size;
    assert_eq!(
        (data.0, data.1),
        (png.width() as usize, png.height() as usize)
    );
    // The file holds what the window shows: the left top of it, pixel by pixel.
    let corner = image::imageops::crop_imm(&png, 0, 0, WIDTH, HEIGHT).to_image();
    let off = difference(&corner, &program.picture());
    assert!(off < 2.0, "the screenshot differs from the window by {off}");

    program.quit();
}
