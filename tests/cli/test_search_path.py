"""Files of a scene that are not where it says: the option --search-path."""

import unittest

from support import DONE, HEADER, SCENE, USAGE, CliTest

SCENE_TEXT = HEADER + 'WorldBegin\nLightSource "infinite"\nInclude "parts/ball.pbrt"\n'


class SearchPath(CliTest):
    def test_files_are_found_there_in_order(self):
        self.write("one/nothing.txt", "")
        self.write("two/parts/ball.pbrt", 'Shape "sphere"\n')
        result = self.render(SCENE_TEXT, "--search-path", "one", "--search-path", "two")
        self.assertEqual((result.code, "warning" in result.stderr), (DONE, False), result)

    def test_the_message_names_where_was_looked(self):
        self.write("one/nothing.txt", "")
        result = self.render(SCENE_TEXT, "--search-path", "one")
        self.assert_fails(result, SCENE, "parts/ball.pbrt", "one")

    def test_a_folder_that_is_missing_is_a_usage_error(self):
        result = self.render(SCENE_TEXT, "--search-path", "nowhere")
        self.assertEqual(result.code, USAGE, result)


if __name__ == "__main__":
    unittest.main()
