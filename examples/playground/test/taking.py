"""What a visitor can take away: pictures, plan, program, code."""

import json
import xml.dom.minidom

# What would be saved is kept instead.
KEEP = """
window.kept = [];
const make = URL.createObjectURL;
URL.createObjectURL = blob => { blob.text().then(text => window.kept.push(text)); return make(blob); };
const click = HTMLAnchorElement.prototype.click;
HTMLAnchorElement.prototype.click = function () { if (!this.download) click.call(this); };
"""


def saved(browser, button):
    browser.run("window.kept.length = 0; document.querySelector(arguments[0]).click()", button)
    browser.wait("window.kept.length", f"what {button} saves")
    return browser.run("return window.kept[0]")


def all_can_be_taken(test, links):
    browser = test.browser
    script = browser.devtools("Page.addScriptToEvaluateOnNewDocument", source=KEEP)["identifier"]
    browser.devtools("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
    for link in links:
        test.open(link)
        test.explained()
        picture = saved(browser, "#save-svg")
        nodes = xml.dom.minidom.parseString(picture).getElementsByTagName("path")
        assert len(nodes) > 2 and "var(" not in picture and "undefined" not in picture
        plan = json.loads(saved(browser, "#save-json"))
        assert plan["answer"]["free"]["steps"] and plan["task"]["timeStep"]
        program = saved(browser, "#save-mps")
        assert "ROWS" in program and program.rstrip().endswith("ENDATA"), program[:200]
        code = browser.text("#code")
        assert "use carom::" in code and "fn main()" in code, code
        browser.run("document.querySelector('#copy').click()")
        browser.wait("document.querySelector('#copy').textContent === 'Copied'", "the copy", 5)
        assert browser.run("return navigator.clipboard.readText()").strip() == code
    browser.devtools("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
    print(f"pictures, plan, program and code of {len(links)} tasks can be taken away")
