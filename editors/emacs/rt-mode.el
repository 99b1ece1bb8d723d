;;; rt-mode.el --- Scenes of rtc, the ray-tracing compiler -*- lexical-binding: t; -*-

;; Version: 0.1.0
;; Package-Requires: ((emacs "27.1"))
;; Keywords: languages, multimedia
;; SPDX-License-Identifier: MIT OR Apache-2.0

;;; Commentary:

;; A major mode for `.rt' files: colours, indentation and comments, and with eglot what the language server of rtc
;; gives.  Where Emacs has tree-sitter and the grammar `rt', `rt-ts-mode' takes its place.
;;
;;   (require 'rt-mode)
;;   (add-hook 'rt-mode-hook #'eglot-ensure)

;;; Code:

(require 'prog-mode)

(defgroup rt nil
  "Scenes of rtc, the ray-tracing compiler."
  :group 'languages)

(defcustom rt-program "rtc"
  "The command `rtc', or its path."
  :type 'string
  :group 'rt)

(defcustom rt-indent-offset 2
  "How many columns a bracket indents by."
  :type 'integer
  :safe #'integerp
  :group 'rt)

;; made from: keywords, between '(" and "), joined by " "
(defconst rt-keywords '("let" "material" "and" "or" "not" "true" "false" "param" "part" "import" "as" "for" "in" "if" "then" "else" "fn" "to" "assert"))

;; made from: kinds, between '(" and "), joined by " "
(defconst rt-kinds '("sphere" "hyperboloid" "paraboloid" "cone" "cylinder" "disk" "box" "mesh" "plane" "group" "diffuse" "mirror" "dielectric" "metal" "plastic" "emitter" "light" "sun" "sky" "camera" "lens" "render"))

;; made from: functions, between '(" and "), joined by " "
(defconst rt-functions '("sin" "cos" "tan" "asin" "acos" "atan2" "sqrt" "abs" "min" "max" "clamp" "mix" "floor" "ceil" "round" "mod" "pow" "exp" "log" "length" "normalize" "dot" "cross" "range" "linspace" "rand" "bounds" "rgb" "srgb" "hsv" "blackbody" "checker" "stripes" "noise" "image" "table" "scale" "turn" "move" "matrix"))

;; made from: types, between '(" and "), joined by " "
(defconst rt-types '("number" "int" "bool" "text" "color" "texture" "material" "thing" "transform" "point" "vector" "length" "angle" "power" "radiance" "temperature" "area"))

;; made from: colours, between '(" and "), joined by " "
(defconst rt-colours '("black" "white" "gray" "grey" "silver" "red" "green" "blue" "yellow" "cyan" "magenta" "orange" "purple" "brown" "pink"))

;; made from: words, between '(" and "), joined by " "
(defconst rt-words '("agx" "auto" "box" "gaussian" "mitchell" "neutral" "none" "sky" "tent" "transparent"))

(defvar rt-mode-syntax-table
  (let ((table (make-syntax-table)))
    (modify-syntax-entry ?/ ". 124b" table)
    (modify-syntax-entry ?* ". 23" table)
    (modify-syntax-entry ?\n "> b" table)
    (modify-syntax-entry ?\" "\"" table)
    (modify-syntax-entry ?\\ "\\" table)
    (modify-syntax-entry ?_ "_" table)
    (dolist (sign '(?+ ?- ?= ?< ?> ?| ?! ?% ?# ?@))
      (modify-syntax-entry sign "." table))
    table)
  "What each character is in a `.rt' file.")

(defconst rt-font-lock-keywords
  `(("@[[:alpha:]_][[:alnum:]_]*" . font-lock-preprocessor-face)
    ("#\\(?:[[:xdigit:]]\\{6\\}\\|[[:xdigit:]]\\{3\\}\\)\\_>" . font-lock-constant-face)
    ;; A name before a colon, whatever it is called.
    ("\\_<\\([[:alpha:]_][[:alnum:]_]*\\)\\_>[ \t]*:" 1 font-lock-variable-name-face)
    (,(concat "\\_<" (regexp-opt '("let" "material" "param") t) "\\_>[ \t]+\\([[:alpha:]_][[:alnum:]_]*\\)")
     (1 font-lock-keyword-face) (2 font-lock-variable-name-face))
    ("\\_<\\(fn\\)\\_>[ \t]+\\([[:alpha:]_][[:alnum:]_]*\\)"
     (1 font-lock-keyword-face) (2 font-lock-function-name-face))
    ("\\_<\\(part\\)\\_>[ \t]+\\([[:alpha:]_][[:alnum:]_]*\\)"
     (1 font-lock-keyword-face) (2 font-lock-type-face))
    (,(concat "\\_<" (regexp-opt '("true" "false") t) "\\_>") . font-lock-constant-face)
    (,(concat "\\_<" (regexp-opt rt-functions t) "\\_>[ \t]*(") 1 font-lock-builtin-face)
    ("\\_<\\([[:alpha:]_][[:alnum:]_]*\\)(" 1 font-lock-function-name-face)
    (,(concat "\\(?::\\|->\\)[ \t]*\\[*" (regexp-opt rt-types t) "\\_>\\]*[ \t]*[=,)]") 1 font-lock-type-face)
    ;; What stands before a brace, with a name between or without.
    ("\\_<\\([[:alpha:]_][[:alnum:]_.]*\\)\\_>\\(?:[ \t]+[[:alpha:]_][[:alnum:]_]*\\)?[ \t]*{" 1 font-lock-type-face)
    (,(concat "\\_<" (regexp-opt rt-keywords t) "\\_>") . font-lock-keyword-face)
    (,(concat ":[ \t]*" (regexp-opt rt-words t) "\\_>") 1 font-lock-constant-face)
    (,(concat "\\_<" (regexp-opt rt-colours t) "\\_>") . font-lock-constant-face)
    ("\\_<[0-9][0-9_]*\\(?:\\.[0-9]+\\)?\\(?:[eE][-+]?[0-9]+\\)?\\([%[:alpha:]][[:alnum:]/]*\\)?" . font-lock-constant-face))
  "Colours of a `.rt' file.")

(defun rt--goes-on-p ()
  "Whether the line at point goes on with the one before.
An `else' that is followed by a body is a statement's."
  (or (looking-at-p "[ \t]*\\(?:|>\\|->\\|[*+<>]\\|/\\(?:[^/*]\\|$\\)\\|[=!]=\\|\\.[[:alpha:]_]\\|\\(?:and\\|or\\|to\\|then\\)\\_>\\)")
      (and (looking-at-p "[ \t]*else\\_>")
           (not (looking-at-p "[ \t]*else[ \t]*{"))
           (not (and (looking-at "[ \t]*else[ \t]+if\\_>[^{\n]*{")
                     (not (string-match-p "\\_<then\\_>" (match-string 0))))))))

(defun rt-indent-line ()
  "Indent the line at point.
That is by `rt-indent-offset' for each bracket around it, and once
more where it goes on with the line before."
  (interactive)
  (let* ((state (save-excursion (syntax-ppss (line-beginning-position))))
         (column
          (save-excursion
            (beginning-of-line)
            (if (nth 4 state)
                (current-indentation)
              (let ((goes-on (rt--goes-on-p))
                    (closes (looking-at-p "[ \t]*[])}]")))
                (if (null (nth 1 state))
                    (if goes-on rt-indent-offset 0)
                  (goto-char (nth 1 state))
                  (+ (current-indentation)
                     (if closes 0 rt-indent-offset)
                     (if goes-on rt-indent-offset 0))))))))
    (if (<= (current-column) (current-indentation))
        (indent-line-to column)
      (save-excursion (indent-line-to column)))))

(defun rt--previous-thing ()
  "Search backward for a thing that has a name; parts are listed apart."
  (let (found)
    (while (and (setq found (re-search-backward
                             "^[ \t]*[[:alpha:]_][[:alnum:]_.]*[ \t]+\\([[:alpha:]_][[:alnum:]_]*\\)[ \t]*{" nil t))
                (looking-at-p "[ \t]*part\\_>")))
    found))

(defconst rt-imenu-expression
  '(("Params" "^[ \t]*param[ \t]+\\([[:alpha:]_][[:alnum:]_]*\\)" 1)
    ("Parts" "^[ \t]*part[ \t]+\\([[:alpha:]_][[:alnum:]_]*\\)" 1)
    ("Functions" "^[ \t]*fn[ \t]+\\([[:alpha:]_][[:alnum:]_]*\\)" 1)
    ("Values" "^[ \t]*\\(?:let\\|material\\)[ \t]+\\([[:alpha:]_][[:alnum:]_]*\\)[ \t]*=" 1)
    ("Things" rt--previous-thing 1))
  "What `imenu' lists.")

(defun rt--command (&rest arguments)
  "A command line of `rt-program' and ARGUMENTS for this file.
What it says of a scene stands on lines that `next-error' knows."
  (mapconcat #'shell-quote-argument
             `(,rt-program ,@arguments "--message-format" "short"
                           ,@(and buffer-file-name (list (file-name-nondirectory buffer-file-name))))
             " "))

(defun rt--set-up ()
  "What both modes have in common."
  (setq-local comment-start "// ")
  (setq-local comment-end "")
  (setq-local comment-start-skip "\\(?://+\\|/\\*+\\)[ \t]*")
  (setq-local indent-tabs-mode nil)
  (setq-local compile-command (rt--command "check")))

(defun rt-preview ()
  "Open the live preview of this scene in the browser, saved or not."
  (interactive)
  (unless (and (fboundp 'eglot-current-server) (eglot-current-server))
    (user-error "The language server is not running: M-x eglot"))
  ;; The server asks for the page to be opened once it is served.  Where its answer is waited for, what it says
  ;; behind the answer is read by Emacs 28 only when it says something more.
  (jsonrpc-async-request (eglot-current-server) :workspace/executeCommand
                         (list :command "rtc.startPreview" :arguments (vector (eglot--TextDocumentIdentifier)))
                         :success-fn #'ignore
                         :error-fn (lambda (wrong) (message "rtc: no preview: %s" (plist-get wrong :message)))))

(defun rt-build ()
  "Render this scene; the picture is put beside its file."
  (interactive)
  (save-buffer)
  (compile (rt--command "build")))

(defvar rt-mode-map
  (let ((map (make-sparse-keymap)))
    (set-keymap-parent map prog-mode-map)
    (define-key map (kbd "C-c C-p") #'rt-preview)
    (define-key map (kbd "C-c C-b") #'rt-build)
    map)
  "Keys of `rt-mode'.")

;;;###autoload
(define-derived-mode rt-mode prog-mode "rt"
  "Major mode for `.rt' files, scenes of rtc."
  (rt--set-up)
  (setq-local font-lock-defaults '(rt-font-lock-keywords))
  (setq-local indent-line-function #'rt-indent-line)
  (setq-local imenu-generic-expression rt-imenu-expression))

;; --- With tree-sitter, from Emacs 29 on ------------------------------------------------------------------------

(declare-function treesit-parser-create "treesit.c")
(declare-function treesit-ready-p "treesit")
(declare-function treesit-font-lock-rules "treesit")
(declare-function treesit-major-mode-setup "treesit")
(declare-function treesit-node-child-by-field-name "treesit.c")
(declare-function treesit-node-check "treesit.c")
(declare-function treesit-node-text "treesit")

(defun rt-ts--font-lock ()
  "Colours by the tree."
  (treesit-font-lock-rules
   :language 'rt :feature 'comment
   '([(comment) (doc_comment)] @font-lock-comment-face)
   :language 'rt :feature 'literal
   '((text) @font-lock-string-face
     [(number) (unit) (color) (boolean)] @font-lock-constant-face)
   :language 'rt :feature 'definition
   '((function name: (identifier) @font-lock-function-name-face)
     (part name: (identifier) @font-lock-type-face)
     (definition name: (identifier) @font-lock-variable-name-face)
     (param name: (identifier) @font-lock-variable-name-face)
     (parameter name: (identifier) @font-lock-variable-name-face)
     (field name: (identifier) @font-lock-property-name-face))
   :language 'rt :feature 'name
   `((thing kind: (_) @font-lock-type-face)
     (construct kind: (_) @font-lock-type-face)
     (type) @font-lock-type-face
     (mark "@" @font-lock-preprocessor-face name: (identifier) @font-lock-preprocessor-face)
     (call function: ((identifier) @font-lock-builtin-face
                      (:match ,(concat "\\`" (regexp-opt rt-functions t) "\\'") @font-lock-builtin-face)))
     (call function: (_) @font-lock-function-name-face)
     ((identifier) @font-lock-constant-face
      (:match ,(concat "\\`" (regexp-opt rt-colours t) "\\'") @font-lock-constant-face)))
   :language 'rt :feature 'keyword
   '((definition keyword: _ @font-lock-keyword-face)
     ["param" "part" "fn" "import" "as" "for" "in" "if" "then" "else" "and" "or" "not" "to" "assert"]
     @font-lock-keyword-face)))

(defun rt-ts--name (node)
  "The name that NODE gives to what it declares, or nil."
  (when-let ((name (treesit-node-child-by-field-name node "name")))
    (treesit-node-text name t)))

(defun rt-ts--named-p (node)
  "Whether NODE is no mere word or sign."
  (treesit-node-check node 'named))

(defvar rt-ts-mode-map
  (let ((map (make-sparse-keymap)))
    (set-keymap-parent map rt-mode-map)
    map)
  "Keys of `rt-ts-mode'.")

;;;###autoload
(define-derived-mode rt-ts-mode prog-mode "rt"
  "Major mode for `.rt' files, scenes of rtc, by tree-sitter."
  :syntax-table rt-mode-syntax-table
  (unless (and (require 'treesit nil t) (treesit-ready-p 'rt t))
    (user-error "Emacs has no tree-sitter grammar for rt; see editors/README.md"))
  (treesit-parser-create 'rt)
  (rt--set-up)
  (setq-local treesit-font-lock-settings (rt-ts--font-lock))
  (setq-local treesit-font-lock-feature-list '((comment definition) (keyword literal) (name)))
  (setq-local indent-line-function #'rt-indent-line)
  ;; Keywords are nodes too, some of the same name.
  (setq-local treesit-defun-type-regexp
              (cons (concat "\\`" (regexp-opt '("thing" "part" "function" "definition")) "\\'") #'rt-ts--named-p))
  (setq-local treesit-simple-imenu-settings
              '(("Params" "\\`param\\'" rt-ts--name nil)
                ("Parts" "\\`part\\'" rt-ts--name nil)
                ("Functions" "\\`function\\'" rt-ts--name nil)
                ("Values" "\\`definition\\'" rt-ts--name nil)
                ("Things" "\\`thing\\'" rt-ts--name nil)))
  (setq-local treesit-defun-name-function #'rt-ts--name)
  (treesit-major-mode-setup))

;;;###autoload
(defun rt-auto-mode ()
  "The mode of a scene: `rt-ts-mode' where Emacs has the grammar, else `rt-mode'."
  (interactive)
  (if (and (fboundp 'treesit-language-available-p) (treesit-language-available-p 'rt))
      (rt-ts-mode)
    (rt-mode)))

;;;###autoload
(add-to-list 'auto-mode-alist '("\\.rt\\'" . rt-auto-mode))

;; --- The language server ---------------------------------------------------------------------------------------

(declare-function eglot-current-server "eglot")
(declare-function eglot--TextDocumentIdentifier "eglot")
(declare-function jsonrpc-async-request "jsonrpc")

(with-eval-after-load 'eglot
  (require 'rt-eglot))

(with-eval-after-load 'compile
  (defvar compilation-error-regexp-alist)
  (defvar compilation-error-regexp-alist-alist)
  (add-to-list 'compilation-error-regexp-alist-alist
               '(rtc "^\\(.+?\\):\\([0-9]+\\):\\([0-9]+\\): \\(?:error\\|\\(warning\\)\\)\\[" 1 2 3 (4)))
  (add-to-list 'compilation-error-regexp-alist 'rtc))

(provide 'rt-mode)

;;; rt-mode.el ends here
