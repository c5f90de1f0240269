# Makes mixed_model.json: Rscript mixed_model.R > mixed_model.json
# Three small studies: 20 people in a Williams square of 8 with trials missing; a study in which people do not
# differ (singular); one factor of three levels. The models are fitted by lme4, tested by lmerTest as if all
# people responded alike, and by clubSandwich (CR2, participants as clusters) as if they did not.
suppressPackageStartupMessages({library(lmerTest); library(emmeans); library(clubSandwich); library(jsonlite)})
options(contrasts = c("contr.sum", "contr.poly"))

williams <- function(k) {
  first <- c(1, 2, as.vector(rbind(k:(k / 2 + 2), 3:(k / 2 + 1))))
  t(sapply(0:(k - 1), function(shift) (first - 1 + shift) %% k + 1))
}

study <- function(labels, people, between, within, effect) {
  square <- williams(length(labels))
  rows <- lapply(seq_len(people), function(person) {
    sequence <- (person - 1) %% nrow(square) + 1
    order <- labels[square[sequence, ]]
    data.frame(participant = sprintf("%02d", person), sequence = sequence, period = seq_along(order),
               condition = order, previous_condition = c("", head(order, -1)),
               value = rnorm(1, 100, between) + effect[order] + 0.8 * seq_along(order) +
                 rnorm(length(order), 0, within), row.names = NULL)
  })
  do.call(rbind, rows)
}

# Previous condition: sum to zero over the conditions, zero in the first period.
carry_over <- function(data) {
  levels <- sort(unique(data$previous_condition[data$previous_condition != ""]))
  first <- levels[-length(levels)]
  columns <- sapply(first, function(level) (data$previous_condition == level) -
                      (data$previous_condition == levels[length(levels)]))
  colnames(columns) <- paste0("after", seq_along(first))
  columns
}

report <- function(data, factors, sequence = FALSE) {
  data[c("period", "sequence")] <- lapply(data[c("period", "sequence")], factor)
  after <- carry_over(data)
  full <- cbind(data, after)
  fixed <- c(paste(factors, collapse = "*"), "period", if (sequence) "sequence", colnames(after))
  formula <- as.formula(paste("value ~", paste(fixed, collapse = "+"), "+ (1|participant)"))
  control <- lmerControl(optCtrl = list(xtol_abs = 1e-14, ftol_abs = 1e-14, xtol_rel = 1e-14, ftol_rel = 1e-14))
  model <- suppressMessages(lmer(formula, full, control = control))
  table <- summary(model)$coefficients
  tests <- anova(model, type = 3)
  keep <- !rownames(tests) %in% colnames(after)
  L <- matrix(0, ncol(after), nrow(table))
  L[cbind(seq_len(ncol(after)), match(colnames(after), rownames(table)))] <- 1
  carried <- contestMD(model, L)
  both <- function(column, extra) c(setNames(tests[keep, column], rownames(tests)[keep]), "carry-over" = extra)
  pairs <- lapply(setNames(factors, factors), function(name)
    contrast(suppressMessages(emmeans(model, as.formula(paste("~", name)))), "pairwise"))
  # Carry-over at its mean: all its columns zero.
  at_mean <- setNames(rep(list(0), ncol(after)), colnames(after))
  periods <- suppressMessages(emmeans(model, ~period, at = at_mean))
  sds <- as.data.frame(VarCorr(model))$sdcor
  list(data = data, factors = I(factors), names = rownames(table), estimate = unname(table[, 1]),
       between_sd = sds[1], within_sd = sds[2], is_singular = isSingular(model),
       alike = list(standard_error = unname(table[, 2]), df = unname(table[, 3]), p = unname(table[, 5]),
                    f = as.list(both("F value", carried[["F value"]])),
                    numerator_df = as.list(both("NumDF", carried$NumDF)),
                    denominator_df = as.list(both("DenDF", carried$DenDF)),
                    f_p = as.list(both("Pr(>F)", carried[["Pr(>F)"]]))),
       robust = robust(model, pairs, periods))
}

robust <- function(model, pairs, periods) {
  covariance <- vcovCR(model, type = "CR2")
  tests <- coef_test(model, covariance, test = "Satterthwaite")
  design <- model.matrix(model)
  labels <- attr(terms(model), "term.labels")[attr(design, "assign")]
  labels[startsWith(labels, "after")] <- "carry-over"
  terms <- lapply(setNames(nm = unique(labels)), function(label) {
    columns <- which(labels == label) + 1
    as.data.frame(Wald_test(model, constrain_zero(columns), covariance, test = "HTZ"))
  })
  given <- function(name) lapply(terms, function(term) term[[name]])
  told <- function(grid) {
    weights <- grid@linfct
    found <- as.data.frame(linear_contrast(model, covariance, weights, p_values = TRUE))
    data.frame(found[c("Est", "SE", "df", "CI_L", "CI_U", "p_val")], row.names = NULL)
  }
  pairs <- lapply(pairs, function(grid) cbind(contrast = as.character(grid@grid[[1]]), told(grid)))
  list(standard_error = tests$SE, df = tests$df_Satt, p = tests$p_Satt, f = given("Fstat"),
       numerator_df = given("df_num"), denominator_df = given("df_denom"), f_p = given("p_val"),
       pairs = pairs, periods = cbind(period = as.character(periods@grid$period), told(periods)))
}

split_levels <- function(data) {
  parts <- do.call(rbind, strsplit(data$condition, "-"))
  cbind(data, intensity = parts[, 1], variety = parts[, 2], transition = parts[, 3])
}

set.seed(20)
labels <- as.vector(outer(outer(c("light", "intense"), c("easy", "hard"), paste, sep = "-"), c("on", "off"),
                          paste, sep = "-"))
effect <- setNames(round(rnorm(8, 0, 4), 1) + ifelse(startsWith(labels, "intense"), 6, 0), labels)
missing <- split_levels(study(labels, 20, 6, 5, effect))[-c(3, 17, 18, 50, 77, 111, 159), ]
alike <- split_levels(study(labels, 12, 0, 5, effect))
levels <- study(c("a", "b", "c", "d"), 10, 8, 2, c(a = 0, b = 1, c = 3, d = 3))
levels <- levels[levels$condition != "d", ]
factors <- c("intensity", "variety", "transition")
found <- list(
  versions = list(R = as.character(getRversion()), lme4 = as.character(packageVersion("lme4")),
                  lmerTest = as.character(packageVersion("lmerTest")),
                  emmeans = as.character(packageVersion("emmeans")),
                  clubSandwich = as.character(packageVersion("clubSandwich"))),
  missing_cells = report(missing, factors), with_sequence = report(missing, factors, TRUE),
  singular = report(alike, factors), three_levels = report(levels, "condition"))
# The data of the second are those of the first.
found$with_sequence$data <- NULL
cat(toJSON(found, digits = 12, auto_unbox = TRUE, dataframe = "columns"))
